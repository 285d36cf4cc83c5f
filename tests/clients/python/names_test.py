# SPDX-License-Identifier: MIT
"""The three clients have the same calls, and their readings the same fields."""
import inspect
import re
import unittest

import harness
import coopdyn

MATLAB = harness.ROOT / "clients" / "matlab" / "+coopdyn"
CPP_HEADER = harness.ROOT / "clients" / "cpp" / "coopdyn_client.h"
CPP_HEADERS = [CPP_HEADER] + [CPP_HEADER.parent / name for name in ("team.h", "run_file.h", "joints.h", "chain.h", "sensors.h",
                                                              "parts.h", "actuators.h")]

SIMULATION = set("""robot robots team step time steps mode dt run pause stop_all reset reload load_scenario set_mode set_step
    set_speed set_participants release_robot status hash scores log logged end_run waiting snapshot describe modules call close
    save_state restore_state saved_states record stop_recording note recording recordings fetch_run
    playback seek play set_play_speed skip set_loop branch open_run close_run
    insert remove move change rename undo redo world save_scenario pick""".split())
ROBOT = set("""name set_velocity set_wheel_speeds stop get_pose get_pose_3d get_distances get_geometry get_targets
    get_target get_robots get_neighbours get_messages send_message get_compass get_support get_wheels get_limits sense joints muscles thrusters channel
    subscribe next call
    get_imu get_wrench get_scan get_contacts get_bumper get_image get_jpeg get_depth get_segmentation get_camera get_battery get_light
    get_sonar get_infrared get_odometry""".split())
JOINTS = set("""name names set_positions set_positions_direct set_velocities set_efforts set_pwm set_modes hold set_compliance set_profile
    set_gains get get_modes get_compliance get_profile get_gains get_limits get_motion arrived get_references get_drive_trains
    get_chain forward inverse""".split())
MUSCLES = {"name", "names", "set_activations", "get", "get_limits"}
THRUSTERS = {"name", "names", "set_thrusts", "get", "get_limits"}
CHANNEL = {"motors", "values", "steps", "set", "get", "aborted"}
TEAM = set("n names ids step step_wheels read select stop release close".split())
RUN = set("file info scenario names time steps hash pose pose_3d reading joints commands events score scores logged".split())
READINGS = set("pose distances targets neighbours wheels compass support joints".split())
FUNCTIONS = {"connect", "launch", "doctor", "read_run"}


def python_names(cls):
    bases = [base for base in cls.__mro__ if base.__module__ == "coopdyn"]
    return {n for base in bases for n in vars(base) if not n.startswith("_")}


def matlab_names(name):
    """Public methods and properties of a classdef file, and of what it inherits from."""
    path = MATLAB / f"{name}.m"
    if not path.exists():
        path = MATLAB / "+internal" / f"{name}.m"
    text = path.read_text(encoding="utf-8")
    inherits = re.search(r"^classdef \w+ < coopdyn\.internal\.(\w+)$", text, re.M)
    names = matlab_names(inherits.group(1)) if inherits else set()
    for kind, access, body in re.findall(r"^  (methods|properties)( \([^)]*\))?\n(.*?)^  end$", text, re.M | re.S):
        if re.search(r"(?<!Set)Access = (private|protected)", access):
            continue
        if kind == "properties":
            names |= set(re.findall(r"^    (\w+)", body, re.M))
        else:
            names |= {n for n in re.findall(r"^    function (?:[^=\n]*= ?)?([\w.]+)", body, re.M)
                      if n != name and not n.startswith("get.")}
    return names


def cpp_class(name):
    text = "".join(path.read_text(encoding="utf-8") for path in CPP_HEADERS)
    return re.search(rf"^(?:class|struct) {name}(?: : public \w+)? {{\n(.*?)^}};$", text, re.M | re.S).group(1)


def cpp_names(name):
    public = re.split(" (?:private|protected):", cpp_class(name))[0]
    public = re.sub(r"//[^\n]*", "", public)
    calls = (re.search(r"(\w+)\(", statement) for statement in public.split(";"))
    inherited = cpp_names("Parts") if name in ("Joints", "Muscles", "Thrusters") else set()
    return {call.group(1) for call in calls if call} - {name} | inherited


def cpp_fields(name):
    fields = set()
    members = re.sub(r"^  \w[^;\n=]*\([^\n]*{[^\n]*}$", "", re.sub(r"//[^\n]*", "", cpp_class(name)), flags=re.M)
    for line in members.split(";"):
        line = re.sub(r"^\s*[\w:]+(<.*>)?\s", "", line.strip())
        fields |= {part.split("=")[0].strip() for part in line.split(",") if part.strip()}
    return fields


def matlab_struct(command):
    text = (MATLAB / "+internal" / "value.m").read_text(encoding="utf-8")
    case = re.search(rf"^    case {command}\n(.*?)^    (?:case|otherwise)", text, re.M | re.S).group(1)
    return set(re.findall(r"'(\w+)', data", case))


class NamesTest(unittest.TestCase):
    def test_simulations_have_the_same_calls(self):
        self.assertEqual(python_names(coopdyn.Simulation), SIMULATION)
        self.assertEqual(matlab_names("Simulation"), SIMULATION)
        self.assertEqual(cpp_names("Simulation"), SIMULATION)

    def test_robots_have_the_same_calls(self):
        self.assertEqual(python_names(coopdyn.Robot), ROBOT)
        self.assertEqual(matlab_names("Robot"), ROBOT)
        self.assertEqual(cpp_names("Robot"), ROBOT)

    def test_joints_have_the_same_calls(self):
        self.assertEqual(python_names(coopdyn.Joints), JOINTS)
        self.assertEqual(matlab_names("Joints"), JOINTS)
        self.assertEqual(cpp_names("Joints"), JOINTS)

    def test_muscles_and_thrusters_have_the_same_calls(self):
        for name, names in (("Muscles", MUSCLES), ("Thrusters", THRUSTERS)):
            with self.subTest(name):
                self.assertEqual(python_names(getattr(coopdyn, name)), names)
                self.assertEqual(matlab_names(name), names)
                self.assertEqual(cpp_names(name), names)

    def test_channels_have_the_same_calls(self):
        self.assertEqual(python_names(coopdyn.Channel), CHANNEL - {"motors", "values", "steps"})  # those are attributes
        self.assertEqual(matlab_names("Channel"), CHANNEL)
        self.assertEqual(cpp_names("Channel"), CHANNEL)

    def test_chains_have_the_same_calls(self):
        for names in (python_names(coopdyn.Chain), matlab_names("Chain"), cpp_names("Chain")):
            self.assertLessEqual({"forward", "inverse"}, names)

    def test_teams_have_the_same_calls(self):
        self.assertEqual(python_names(coopdyn.Team), TEAM)
        self.assertEqual(matlab_names("Team"), TEAM)
        self.assertEqual(cpp_names("Team"), TEAM)

    def test_runs_have_the_same_calls(self):
        self.assertEqual(python_names(coopdyn.Run), RUN)
        self.assertEqual(matlab_names("Run"), RUN)
        self.assertEqual(cpp_names("Run"), RUN)

    def test_runs_have_the_same_readings(self):
        matlab = re.search(r"known = {(.*?)}", (MATLAB / "Run.m").read_text(encoding="utf-8")).group(1)
        cpp = (CPP_HEADER.parent / "run_file.cc").read_text(encoding="utf-8")
        listed = re.search(r"kReadings = {(.*?)}", cpp).group(1)
        self.assertEqual(tuple(re.findall(r"'(\w+)'", matlab)), coopdyn._RUN_READINGS)
        self.assertEqual(tuple(re.findall(r'"(\w+)"', listed)), coopdyn._RUN_READINGS)

    def test_what_is_told_of_runs_has_the_same_fields(self):
        matlab = "".join((MATLAB / name).read_text(encoding="utf-8") for name in ("+internal/RunCalls.m", "Run.m"))
        structs = [set(re.findall(r"'(\w+)', ", body)) for body in re.findall(r" = struct\((.*?)\);", matlab, re.S)]
        for name in ("Recording", "RunFile", "Playback", "SavedState", "Event"):
            with self.subTest(name):
                fields = set(getattr(coopdyn, name)._fields)
                self.assertEqual(cpp_fields(name), fields)
                self.assertIn(fields, structs)
        self.assertEqual(cpp_fields("Recorded"), set(coopdyn.Recorded._fields))

    def test_teams_have_the_same_readings(self):
        self.assertEqual(set(coopdyn._READINGS), READINGS)
        self.assertEqual(set(coopdyn.TeamReading.__annotations__), READINGS | {"time", "step", "text"})
        self.assertEqual(cpp_fields("TeamReading"), READINGS | {"time", "step", "text", "modules", "values"})
        known = re.search(r"known = {(.*?)}", (MATLAB / "Team.m").read_text(encoding="utf-8")).group(1)
        self.assertEqual(set(re.findall(r"'(\w+)'", known)), READINGS)

    def test_packages_have_the_same_functions(self):
        functions = {n for n, f in inspect.getmembers(coopdyn, inspect.isfunction)
                     if not n.startswith("_") and f.__module__ == "coopdyn"}
        self.assertEqual(functions - {"encode", "decode"}, FUNCTIONS)
        self.assertEqual({p.stem for p in MATLAB.glob("*.m")} - {"Simulation", "Robot", "Team", "Run", "Joints", "Muscles",
                                                                "Thrusters", "Channel", "Chain"}, FUNCTIONS)
        headers = "".join(path.read_text(encoding="utf-8") for path in CPP_HEADERS)
        self.assertEqual(set(re.findall(r"^(?:Simulation|bool|Run) (\w+)\(", headers, re.M)), FUNCTIONS)

    def test_readings_have_the_same_fields(self):
        for command, name in ((12, "Wheels"), (13, "Limits"), (21, "Geometry"), (31, "Bearing"), (40, "Pose"), (41, "Pose3d"),
                              (203, "JointReading"), (211, "Compliance"), (213, "Profile"), (215, "Gains"), (216, "JointLimits"),
                              (223, "DriveTrains"), (225, "MuscleReading"), (226, "MuscleLimits"), (228, "ThrusterReading"),
                              (229, "ThrusterLimits"),
                              (230, "Imu"), (240, "Wrench"), (271, "Camera"), (280, "Support"), (290, "Battery"), (340, "Odometry")):
            with self.subTest(name):
                fields = set(getattr(coopdyn, name)._fields)
                self.assertEqual(cpp_fields(name), fields)
                self.assertEqual(matlab_struct(command), fields)
        for name in ("Target", "OtherRobot", "Heard", "Reading", "Awaited", "Module", "Scan", "Contact"):
            if name != "Module":
                with self.subTest(name):
                    self.assertEqual(cpp_fields(name), set(getattr(coopdyn, name)._fields))

    def test_errors_have_the_same_words(self):
        words = [coopdyn.Error(code, "").name for code in range(1, 13)]
        matlab = (MATLAB / "+internal" / "fail.m").read_text(encoding="utf-8")
        self.assertEqual(re.findall(r"'(\w+)'", re.search(r"names = {(.*?)}", matlab, re.S).group(1)), words)
        cpp = (harness.ROOT / "clients" / "cpp" / "connection.cc").read_text(encoding="utf-8")
        listed = re.search(r"kNames\[\] = \{(.*?)\};", cpp, re.S).group(1)
        self.assertEqual(re.findall(r'"(\w+)"', listed)[1:], words)

    def numbers(self, path, pattern):
        text = (harness.ROOT / "clients" / path).read_text(encoding="utf-8")
        return {re.sub(r"^k(?=[A-Z])|_(s|m|rad)$", "", key).replace("_", "").lower(): float(number.group())
                for key, value in re.findall(pattern, text, re.M) if (number := re.search(r"\d[\d.]*", value))}

    def test_the_attractor_has_the_same_numbers(self):
        python = self.numbers("python/attractor.py", r"^([A-Z_]{4,}) = ([^#\n]+)")
        self.assertGreaterEqual(len(python), 14)
        self.assertEqual(self.numbers("cpp/attractor.cc", r"^constexpr double (k\w+) = ([^;]+);"), python)
        self.assertEqual(self.numbers("matlab/attractor.m", r"^  p\.(\w+) = ([^;]+);"), python)

    def test_programs_that_use_sensors_have_the_same_numbers(self):
        for name, least in (("ball", 11), ("wall", 12), ("pendulum", 10)):
            with self.subTest(name):
                python = self.numbers(f"python/{name}.py", r"^([A-Z_]{3,}) = ([^#\n]+)")
                self.assertGreaterEqual(len(python), least)
                self.assertEqual(self.numbers(f"cpp/{name}.cc", r"^constexpr double (k\w+) = ([^;]+);"), python)
                self.assertEqual(self.numbers(f"matlab/{name}.m", r"^  p\.(\w+) = ([^;]+);"), python)

    def test_teams_have_the_same_numbers(self):
        for name, least in (("transport", 27), ("formation", 18)):
            with self.subTest(name):
                cpp = self.numbers(f"plugin/samples/{name}_dynamics.h", r"^constexpr double (k\w+) = ([^;]+);")
                cpp.pop("pi")
                python = self.numbers(f"python/{name}.py", r"^([A-Z_]{4,}) = ([^#\n]+)")
                matlab = self.numbers(f"matlab/{name}.m", r"^  p\.(\w+) = ([^;]+);")
                self.assertGreaterEqual(len(cpp), least)
                for key, value in cpp.items():
                    self.assertEqual((python[key], matlab[key]), (value, value), key)


if __name__ == "__main__":
    unittest.main()

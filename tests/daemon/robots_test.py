"""The shipped robots with joints: they stand, hold, walk, squat and drive as their READMEs say, and repeat bit for bit."""
import math
import random
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from harness import BINARY, LIMIT_S, Daemon
from recording import equal_steps

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "clients" / "python"))
import coopdyn  # noqa: E402

ARMS = {"lwa": (7, 5.0), "irb120": (6, 3.0), "mh5": (6, 5.0)}  # joints, payload in kg
ALL = [*ARMS, "mobile_arm", "quadruped", "hexapod", "humanoid", "car"]


def robots(*entries, more=""):
    """A scenario: (type, lines) for each robot, 3 m apart along y; they are called r1, r2, ..."""
    text = "[FLOOR]\nsize 60 60\n" + more
    for number, (kind, lines) in enumerate(entries, 1):
        text += f"[ROBOT_{number}]\ntype {kind}\nname r{number}\n"
        if "position" not in lines:
            text += f"position 0 {3 * (number - 1)}\n"
        text += lines + "\n"
    return text


def lean(pose):
    """The angle of a robot's z axis from the vertical."""
    w, x, y, z = pose[3:]
    return math.acos(max(-1, min(1, 1 - 2 * (x * x + y * y))))


class RobotsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.runs = 0

    def serve(self, text, seconds, *options, name="robots.scenario"):
        """Runs a scenario to its end without sockets; returns the recording's file."""
        self.runs += 1
        scenario = self.folder / name
        scenario.write_text(text)
        file = self.folder / f"{self.runs}.run"
        done = subprocess.run([BINARY, "serve", scenario, "--mode", "free", "--duration", str(seconds), "--no-net", "--record", file,
                               "--scenarios", self.folder, *options], capture_output=True, text=True, timeout=4 * LIMIT_S)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("nothing frozen", done.stderr)
        return file

    def run_to_the_end(self, text, seconds, *options, **more):
        return coopdyn.read_run(self.serve(text, seconds, *options, **more))

    def loaded(self, arm, payload_kg):
        """A new type: the arm with a ball of that mass in its tool."""
        kind = f"{arm}_loaded"
        text = (ROOT / "robots" / arm / "model.sdf").read_text()
        moment = 0.4 * payload_kg * 0.05**2
        at = re.search(r'<link name="tool">\s*<pose>(\S+ \S+ \S+) ', text).group(1)
        ball = (f'<link name="load"><pose>{at} 0 0 0</pose><inertial><mass>{payload_kg}</mass><inertia><ixx>{moment}</ixx><iyy>{moment}</iyy>'
                f'<izz>{moment}</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial></link>'
                '<joint name="grip" type="fixed"><parent>tool</parent><child>load</child></joint>')
        folder = self.folder / "robots" / kind
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "model.sdf").write_text(text.replace("</model>", ball + "</model>").replace(f'name="{arm}"', f'name="{kind}"'))
        return kind

    def test_a_hollow_ball_of_an_sdf_world_rolls_by_its_moment(self):
        radius_m, slope, seconds = 0.1, 0.1, 2
        moment = 2 / 3 * radius_m**2  # of 1 kg
        world = (f'<sdf version="1.9"><world name="slope"><gravity>{9.81 * math.sin(slope)} 0 {-9.81 * math.cos(slope)}</gravity>'
                 f'<include><uri>model://ground_plane</uri></include><model name="hollow"><pose>0 0 {radius_m} 0 0 0</pose><link name="ball">'
                 f'<inertial><mass>1</mass><inertia><ixx>{moment}</ixx><iyy>{moment}</iyy><izz>{moment}</izz></inertia></inertial>'
                 f'<collision name="c"><geometry><sphere><radius>{radius_m}</radius></sphere></geometry></collision></link></model></world></sdf>')
        exact_m = 9.81 * math.sin(slope) / (1 + 2 / 3) * seconds**2 / 2
        for step in ("0.001", "0.005", "0.01"):
            with self.subTest(step=step):
                run = self.run_to_the_end(world, seconds, "--step", step, name="slope.sdf")
                rolled_m = run.pose_3d("hollow")[-1][0]
                self.assertAlmostEqual(rolled_m, exact_m, delta=0.01 * exact_m)

    def test_each_stands_for_ten_seconds(self):
        for kind in ALL:
            with self.subTest(robot=kind):
                run = self.run_to_the_end(robots((kind, "")), 10)
                first, last = run.pose_3d("r1")[0], run.pose_3d("r1")[-1]
                self.assertLess(math.dist(first[:3], last[:3]), 2e-3, "it drifts by 2 mm at most")
                self.assertLess(lean(last), math.radians(0.5))
                joints = run.joints("r1")
                row = run.reading("r1", "channels")[-1]
                for joint, position in zip(joints, row):
                    self.assertLess(abs(position), math.radians(0.2), joint)

    def hold(self, arm, kind, most_rad):
        """Holds twenty random postures, 2 m above the floor, so that only gravity acts."""
        count = ARMS[arm][0]
        chance = random.Random(7)
        with Daemon("[SIMULATION]\nmode lockstep\n" + robots((kind, "position 0 0 2")), "--scenarios", str(self.folder)) as daemon:
            module = daemon.text("/r1/arm")
            limits = module.must("get_limits").data[:4 * count]
            for _ in range(20):
                wanted = [chance.uniform(0.8 * limits[4 * i], 0.8 * limits[4 * i + 1]) for i in range(count)]
                module.must("set_positions " + " ".join(map(repr, wanted)))
                for _ in range(40):
                    module.must("ready 50")
                    if all(module.must("get_motion").params):
                        break
                module.must("ready 50")
                there = module.must("get_joints").data[0:3 * count:3]
                self.assertLess(max(abs(a - b) for a, b in zip(wanted, there)), most_rad, (wanted, there))

    def test_each_arm_holds_twenty_postures(self):
        for arm in ARMS:
            with self.subTest(robot=arm):
                self.hold(arm, arm, math.radians(0.1))

    def test_each_arm_holds_twenty_postures_with_its_payload(self):
        for arm, (_, payload_kg) in ARMS.items():
            with self.subTest(robot=arm):
                self.hold(arm, self.loaded(arm, payload_kg), math.radians(0.5))

    def test_two_copies_of_an_arm_answer_on_their_own_names(self):
        with Daemon("[SIMULATION]\nmode lockstep\n" + robots(("irb120", ""), ("irb120", ""))) as daemon:
            one, other = daemon.text("/r1/arm"), daemon.text("/r2/arm")
            one.send("set_positions_direct (1) 0.01")
            other.send("set_positions_direct (1) -0.02")
            one.receive()
            other.receive()
            self.assertAlmostEqual(one.must("get_joints (1)").data[0], 0.01, delta=1e-3)
            self.assertAlmostEqual(other.must("get_joints (1)").data[0], -0.02, delta=1e-3)

    def test_axis_six_of_the_irb120_turns_400_degrees_both_ways(self):
        with Daemon("[SIMULATION]\nmode lockstep\n" + robots(("irb120", ""))) as daemon:
            arm = daemon.text("/r1/arm")
            for degrees in (400, -400):
                arm.must(f"set_positions (6) {math.radians(degrees)}")
                for _ in range(40):
                    arm.must("ready 50")
                    if all(arm.must("get_motion (6)").params):
                        break
                self.assertAlmostEqual(math.degrees(arm.must("get_joints (6)").data[0]), degrees, delta=0.1)

    def test_a_mobile_arm_has_two_modules_that_two_programs_may_hold(self):
        with Daemon("[SIMULATION]\nmode lockstep\n" + robots(("mobile_arm", ""))) as daemon:
            motors, arm = daemon.text("/r1/motors"), daemon.text("/r1/arm")
            for _ in range(100):
                motors.send("set_velocity 0.2 0")
                arm.send("set_velocities (1) 0.5")
                self.assertEqual((motors.receive().error, arm.receive().error), (0, 0))
            self.assertGreater(daemon.text("/r1/pose").must("get_pose").data[0], 0.15)
            self.assertAlmostEqual(arm.must("get_joints (1)").data[0], 0.5, delta=0.02)

    def driven(self, motors, pose, command, steps=300):
        """Drives the car by `command` for some seconds; returns the reply, and its speed and turn rate in the last second."""
        reply = motors.must(f"{command[0]} ({steps - 100}) {command[1]} {command[2]}")
        x, y, heading = pose.must("get_pose").data[:3]
        way = turned = 0
        for _ in range(10):
            motors.must(f"{command[0]} (10) {command[1]} {command[2]}")
            at = pose.must("get_pose").data
            way += math.dist((x, y), at[:2])
            turned += math.remainder(at[2] - heading, 2 * math.pi)
            x, y, heading = at[:3]
        return reply, way, turned

    def test_a_car_drives_circles_forward_and_backward(self):
        with Daemon("[SIMULATION]\nmode lockstep\n" + robots(("car", ""))) as daemon:
            motors, pose = daemon.text("/r1/motors"), daemon.text("/r1/pose")
            for linear, angular in ((0.8, 0.5), (0.8, -0.5), (0.3, 0.4), (-0.5, 0.5)):
                with self.subTest(linear=linear, angular=angular):
                    reply, speed, rate = self.driven(motors, pose, ("set_velocity", linear, angular))
                    self.assertEqual(reply.text, "")
                    self.assertAlmostEqual(speed, abs(linear), delta=0.02 * abs(linear))
                    self.assertAlmostEqual(rate, angular, delta=0.02 * abs(angular))
                    wheels = motors.must("get_wheels").data
                    self.assertAlmostEqual((wheels[3] - wheels[2]) * 0.0508 / 0.27, angular, delta=0.02 * abs(angular))

    def test_a_car_turns_no_tighter_than_its_stops_allow_and_says_so(self):
        inner_rad, wheelbase_m, half_track_m = 0.6, 0.3302, 0.135
        tightest_m = wheelbase_m / math.tan(inner_rad) + half_track_m
        with Daemon("[SIMULATION]\nmode lockstep\n" + robots(("car", ""))) as daemon:
            motors, pose = daemon.text("/r1/motors"), daemon.text("/r1/pose")
            for angular in (3, -3):
                reply, speed, rate = self.driven(motors, pose, ("set_velocity", 0.4, angular))
                self.assertEqual(reply.text, f"limited to 0.4 m/s {math.copysign(0.4 / tightest_m, angular):.6g} rad/s")
                self.assertAlmostEqual(speed / abs(rate), tightest_m, delta=0.02 * tightest_m)
            reply, speed, rate = self.driven(motors, pose, ("set_wheel_speeds", 0, 10))
            self.assertIn("limited to", reply.text)
            self.assertAlmostEqual(speed / rate, tightest_m, delta=0.02 * tightest_m)
            reply, speed, rate = self.driven(motors, pose, ("set_velocity", 0, 1))
            self.assertEqual(reply.text, "limited to 0 m/s 0 rad/s")
            self.assertLess(max(speed, abs(rate)), 1e-3)

    def test_a_car_stops(self):
        with Daemon("[SIMULATION]\nmode lockstep\n" + robots(("car", ""))) as daemon:
            motors, pose = daemon.text("/r1/motors"), daemon.text("/r1/pose")
            motors.must("set_velocity (200) 1 0.8")
            motors.must("stop (50)")
            there = pose.must("get_pose").data
            motors.must("stop (50)")
            self.assertLess(math.dist(there[:3], pose.must("get_pose").data[:3]), 1e-4)

    def test_the_quadruped_trots(self):
        for step_s in (0.01, 0.005):
            with self.subTest(step=step_s):
                run = self.run_to_the_end(robots(("quadruped", "controller trot")), 11, "--step", str(step_s))
                poses = run.pose_3d("r1")
                start = poses[round(1 / step_s)]
                self.assertGreater(poses[-1][0] - start[0], 0.1 * 10, "0.1 m/s for ten seconds")
                self.assertLess(max(map(lean, poses)), math.radians(15))

    def test_the_hexapod_walks(self):
        run = self.run_to_the_end(robots(("hexapod", "controller tripod")), 11)
        poses = run.pose_3d("r1")
        self.assertGreater(poses[-1][0] - poses[100][0], 0.05 * 10, "half of what its controller wants, at least")
        self.assertLess(max(map(lean, poses)), math.radians(10))

    def test_the_humanoid_squats(self):
        run = self.run_to_the_end(robots(("humanoid", "controller squat depth=0.1 period=4 wait=1")), 11)
        poses = run.pose_3d("r1")
        height_m = [pose[2] for pose in poses]
        for down, up in ((300, 500), (700, 900)):
            self.assertAlmostEqual(height_m[down], height_m[0] - 0.1, delta=0.01)
            self.assertAlmostEqual(height_m[up], height_m[0], delta=0.01)
        self.assertLess(max(map(lean, poses)), math.radians(5))

    def test_the_humanoid_walks(self):
        for step_s, options in ((0.01, "length=0.06"), (0.01, "length=0.1 period=0.6"), (0.01, "length=0"), (0.005, "length=0.06")):
            with self.subTest(step=step_s, options=options):
                run = self.run_to_the_end(robots(("humanoid", f"controller walk steps=20 wait=1 {options}")), 19, "--step", str(step_s))
                poses = run.pose_3d("r1")
                length_m = float(options.split()[0].split("=")[1])
                self.assertAlmostEqual(poses[-1][0], 19 * length_m, delta=0.05 + 0.05 * 19 * length_m)
                self.assertLess(max(map(lean, poses)), math.radians(3))
                self.assertAlmostEqual(poses[-1][2], -0.035, delta=0.005)

    def pendulum(self, mass_kg):
        """A ball that swings down from the horizontal about a post and hits the robot 0.85 m below the pivot."""
        moment = 0.4 * mass_kg * 0.05**2
        folder = self.folder / "robots" / "pendulum"
        folder.mkdir(parents=True, exist_ok=True)
        inertial = ("<inertial><mass>{0}</mass><inertia><ixx>{1}</ixx><iyy>{1}</iyy><izz>{1}</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia>"
                    "</inertial>")
        (folder / "model.sdf").write_text(
            '<sdf version="1.9" xmlns:coopdyn="https://coopdyn.dev/sdf"><model name="pendulum">'
            f'<link name="post"><pose>0 0 1.5 0 0 0</pose>{inertial.format(1, 0.01)}'
            '<collision name="c"><geometry><sphere><radius>0.02</radius></sphere></geometry></collision></link>'
            '<joint name="ground" type="fixed"><parent>world</parent><child>post</child></joint>'
            f'<link name="ball"><pose>-0.75 0 1.5 0 0 0</pose>{inertial.format(mass_kg, moment)}'
            '<collision name="c"><geometry><sphere><radius>0.05</radius></sphere></geometry></collision></link>'
            '<joint name="pivot" type="revolute"><pose relative_to="__model__">0 0 1.5 0 0 0</pose><parent>post</parent><child>ball</child>'
            '<axis><xyz expressed_in="__model__">0 1 0</xyz></axis></joint><coopdyn:module type="pose"/></model></sdf>')

    def pushed(self, mass_kg, lines):
        """Runs the humanoid for 5 s; the ball hits its chest at 3.8 m/s after half a second."""
        self.pendulum(mass_kg)
        run = self.run_to_the_end(robots(("humanoid", "position 0.12 0\n" + lines), ("pendulum", "position 0 0")), 5)
        return run.pose_3d("r1")

    def test_the_humanoid_stands_a_push(self):
        poses = self.pushed(1.5, "")  # up to 5.7 N s
        self.assertGreater(max(map(lean, poses)), math.radians(0.5), "it was pushed")
        self.assertLess(lean(poses[-1]), math.radians(0.5))
        self.assertAlmostEqual(poses[-1][2], poses[0][2], delta=0.01)

    def test_the_humanoid_recovers_from_a_push_that_tilts_it(self):
        for lines, height_m in (("controller squat depth=0", 0), ("controller walk length=0", -0.035)):
            with self.subTest(controller=lines):
                poses = self.pushed(2.85, lines)  # up to 10.8 N s; without a controller it falls
                self.assertGreater(max(map(lean, poses)), math.radians(3))
                self.assertLess(lean(poses[-1]), math.radians(0.5))
                self.assertAlmostEqual(poses[-1][2], height_m, delta=0.005)

    def test_any_number_of_threads_gives_the_same_bits(self):
        text = robots(*[(kind, f"controller {controller}") for kind, controller in
                        (("lwa", "reach"), ("mh5", "reach"), ("quadruped", "trot"), ("quadruped", "trot turn=0.2"), ("hexapod", "tripod"),
                         ("humanoid", "squat"), ("humanoid", "squat period=2"))], ("irb120", ""), ("car", ""), ("mobile_arm", ""))
        hashes = [self.run_to_the_end(text, 2, "--threads", str(threads)).hash for threads in (1, 2, 4)]
        self.assertEqual(len(hashes[0]), 201)
        self.assertEqual(hashes[0], hashes[1])
        self.assertEqual(hashes[0], hashes[2])

    def test_a_recording_verifies_and_branches(self):
        file = self.serve(robots(("lwa", "controller reach"), ("quadruped", "controller trot"), ("hexapod", "controller tripod"),
                                 ("humanoid", "controller squat")), 3)
        self.assertEqual(equal_steps(file), 300)
        branch = self.folder / "branch.run"
        done = subprocess.run([BINARY, "serve", "--from", f"{file}@1.5", "--mode", "free", "--duration", "3", "--no-net", "--record", branch],
                              capture_output=True, text=True, timeout=4 * LIMIT_S)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(coopdyn.read_run(branch).hash[-1], coopdyn.read_run(file).hash[-1])

    def test_a_reset_begins_the_same_run_again(self):
        text = "[SIMULATION]\nmode lockstep\n" + robots(("irb120", ""), ("quadruped", ""))
        with Daemon(text) as daemon:
            arm, legs, simulation = daemon.text("/r1/arm"), daemon.text("/r2/legs"), daemon.text("/simulation")
            hashes = []
            for _ in range(2):
                arm.send("set_positions (2 3) 0.5 -0.5")
                legs.send("set_positions (2 3) 0.2 -0.2")
                arm.receive()
                legs.receive()
                arm.send("ready 50")
                legs.send("ready 50")
                arm.receive()
                legs.receive()
                hashes.append(daemon.status()["hash"])
                simulation.must("reset")
            self.assertEqual(hashes[0], hashes[1])


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: MIT
"""The output of `coopdyn check` for scenarios and models."""
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import BINARY


def run(*arguments, **more):
    return subprocess.run([BINARY, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120, **more)


class ScenarioTest(unittest.TestCase):
    def test_every_shipped_scenario_is_right_and_summed_up_in_a_line(self):
        folder = Path(__file__).parents[2] / "scenarios"
        names = sorted(str(path) for path in folder.glob("*.scenario"))
        self.assertGreaterEqual(len(names), 8)
        done = run("check", *names)
        self.assertEqual((done.returncode, done.stderr), (0, b""))
        self.assertEqual(len(done.stdout.decode().splitlines()), len(names))

    def test_a_picture_of_a_scenario_is_a_png(self):
        with tempfile.TemporaryDirectory() as folder:
            picture = Path(folder) / "p.png"
            done = run("check", "classroom", "--picture", str(picture))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue(picture.read_bytes().startswith(b"\x89PNG"))

    def test_digests_tell_what_a_scenario_is_made_of_as_the_summary_and_a_recording_do(self):
        with tempfile.TemporaryDirectory() as folder:
            words = ("diffuse100", "--set", "SWARM_1.count=5")
            done = run("check", "--digests", *words)
            digests = json.loads(done.stdout)
            libraries = {name for name in digests if name.startswith("library ")}
            self.assertTrue(any("libode" in name for name in libraries), digests)
            self.assertEqual(set(digests) - libraries,
                             {"build", "scenario", "world square10.world", "robot minibot", "controller diffuse"}, done.stderr)
            self.assertNotEqual(json.loads(run("check", "--digests", "diffuse100").stdout)["scenario"], digests["scenario"])
            recording = f"{folder}/a.run"
            told = run("serve", *words, "--no-net", "--mode", "free", "--steps", "5", "--summary", "/dev/stdout", "--record", recording).stdout.decode()
            self.assertEqual(json.loads(told[told.index("{"):])["digests"], digests)
            self.assertEqual(json.loads(run("info", "--json", recording).stdout)[0]["digests"], digests)

    def test_ten_mistakes_print_ten_diagnostics(self):
        wrong = """[FLOOR]
size 10 10
[SIMULATION]
mode quick
step 0.2
[TARGET]
red 1 two 0
[BOX_1]
type bx
size 1 1 1
position 3 3
[CRATE_1]
type box
size 1 -1 1
position 0 4
[ROBOT_1]
type cooopbot
name robot1
position 0 0
[ROBOT_2]
type coopbot
name ro bot
position 0,5 2
[ROBOT_3]
type coopbot
name robot3
position 2 2
speeed 3
[CRATE_1]
type sphere
size 1
position 4 4
"""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "ten.scenario"
            path.write_text(wrong)
            done = run("check", str(path))
            lines = done.stderr.decode().strip().splitlines()
            self.assertEqual(done.returncode, 1)
            self.assertEqual(len(lines), 10, "\n".join(lines))
            self.assertTrue(all(re.match(r".*ten\.scenario:\d+: error: ", line) for line in lines), lines)


    def test_a_controller_that_cannot_drive_its_robot_says_why_at_its_line(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "wrong.scenario"
            path.write_text("[ROBOT_1]\ntype lwa\nposition 0 0\ncontroller trot\n")
            done = run("check", str(path))
            said = done.stderr.decode()
            self.assertRegex(said, r"wrong\.scenario:4: warning: controller trot cannot drive it: .*; robot1 will stand")
            self.assertNotIn("exception", said)


class ModelTest(unittest.TestCase):
    MODEL = """<robot name="gripper">
  <link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
    <collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="left"><inertial><mass value="0.25"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
  <link name="right"><inertial><mass value="0.25"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
  <link name="lid"><inertial><mass value="0.5"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
  <joint name="l" type="prismatic"><parent link="base"/><child link="left"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.04" effort="20" velocity="0.2"/></joint>
  <joint name="r" type="prismatic"><parent link="base"/><child link="right"/><axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.04" effort="20" velocity="0.2"/><mimic joint="l" multiplier="2" offset="0.01"/></joint>
  <joint name="hinge" type="continuous"><parent link="base"/><child link="lid"/><axis xyz="0 0 1"/>
    <limit effort="3" velocity="1.5"/></joint>
</robot>
"""

    def test_a_world_of_the_current_folder_is_checked_by_its_name(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "arm.urdf").write_text(self.MODEL)
            (Path(folder) / "lab.sdf").write_text('<sdf version="1.9"><world name="lab"><include><uri>model://sun</uri></include>'
                                                  "<include><uri>arm.urdf</uri></include></world></sdf>")
            done = run("check", "lab.sdf", cwd=folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            lines = done.stdout.decode().splitlines()
            self.assertEqual(lines[0], "lab.sdf: runs")
            self.assertIn("SDF 1.9 'lab': 1 robot", lines[1])

    def test_meshes_of_a_package_or_from_the_root_are_found_in_the_models_folder(self):
        cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
        for uri in ("package://meshes/cube.obj", "model:///meshes/cube.obj", "/meshes/cube.obj"):
            with self.subTest(uri), tempfile.TemporaryDirectory() as folder:
                (Path(folder) / "meshes").mkdir()
                (Path(folder) / "meshes" / "cube.obj").write_text(cube)
                (Path(folder) / "a.urdf").write_text(
                    '<robot name="a"><link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>'
                    f'<collision><geometry><mesh filename="{uri}"/></geometry></collision></link></robot>')
                done = run("check", "a.urdf", cwd=folder)
                self.assertEqual(done.returncode, 0, done.stderr)

    LINK = ('<robot name="a"><link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>'
            '<collision><geometry><mesh filename="{}"/></geometry></collision></link></robot>')
    CUBE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"

    def test_a_missing_mesh_is_an_error_if_strict(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "a.urdf").write_text(self.LINK.format("package://hands/meshes/m.obj"))
            done = run("check", "a.urdf", cwd=folder)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn("a box that has the link's inertia collides", done.stderr.decode())
            done = run("check", "--strict", "a.urdf", cwd=folder)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn("a.urdf:1: error: mesh: there is no 'package://hands/meshes/m.obj'", done.stderr.decode())

    def test_search_names_the_folders_that_have_what_a_model_names(self):
        with tempfile.TemporaryDirectory() as folder:
            meshes = Path(folder) / "ws" / "src" / "hands" / "meshes"
            meshes.mkdir(parents=True)
            (meshes / "m.obj").write_text(self.CUBE)
            (Path(folder) / "a.urdf").write_text(self.LINK.format("package://hands/meshes/m.obj"))
            done = run("check", "--strict", "--search", "ws", "a.urdf", cwd=folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("a.urdf: what it names is found with --scenarios ws/src", done.stdout.decode())
            done = run("check", "--strict", "--scenarios", "ws/src", "a.urdf", cwd=folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            (meshes / "m.obj").unlink()
            done = run("check", "--search", "ws", "a.urdf", cwd=folder)
            self.assertIn("a.urdf: 'package://hands/meshes/m.obj' is nowhere in ws", done.stdout.decode())

    def test_the_line_that_serves_it_works_when_it_is_pasted(self):
        with tempfile.TemporaryDirectory() as folder:
            meshes = Path(folder) / "it's a folder" / "hands" / "meshes"
            meshes.mkdir(parents=True)
            (meshes / "m.obj").write_text(self.CUBE)
            (Path(folder) / "my arm.urdf").write_text(self.LINK.format("package://hands/meshes/m.obj"))
            said = run("check", "--strict", "--search", ".", "my arm.urdf", cwd=folder).stdout.decode().splitlines()
            line = said[said.index("Serve it:") + 1]
            self.assertEqual(line, "  coopdyn serve 'my arm.urdf' --strict --scenarios './it'\\''s a folder'")
            path = f"{Path(BINARY).resolve().parent}:{os.environ['PATH']}"
            done = subprocess.run(f"{line} --no-net --no-render --steps 1", shell=True, cwd=folder, env={**os.environ, "PATH": path},
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120)
            self.assertEqual(done.returncode, 0, done.stdout)

    def test_folders_of_gazebo_and_ros_are_taken_from_their_variables(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "a.urdf").write_text(self.LINK.format("package://hands/meshes/m.obj"))
            meshes = Path(folder) / "here" / "share" / "hands" / "meshes"
            meshes.mkdir(parents=True)
            (meshes / "m.obj").write_text(self.CUBE)
            for variable, value in (("AMENT_PREFIX_PATH", f"/none:{folder}/here"), ("ROS_PACKAGE_PATH", f"{folder}/here/share"),
                                    ("GZ_SIM_RESOURCE_PATH", f"{folder}/here/share"), ("GAZEBO_MODEL_PATH", f"{folder}/here/share/hands")):
                with self.subTest(variable):
                    done = run("check", "--strict", "a.urdf", cwd=folder, env={**os.environ, variable: value})
                    self.assertEqual(done.returncode, 0, done.stderr)

    def test_the_listing_of_a_model_names_joints_with_units_couplings_and_what_modules_have(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "gripper.urdf"
            path.write_text(self.MODEL)
            done = run("check", str(path))
            self.assertEqual(done.returncode, 0, done.stderr)
            lines = done.stdout.decode().splitlines()
            self.assertEqual(lines[0], f"{path}: runs")
            self.assertIn("URDF 'gripper': robot gripper, 4 links, 3 joints, 2 modules; mass 2 kg, ", lines[1])
            self.assertEqual(lines[2:10], [
                "  size 0.2 x 0.2 x 0.2 m; 2 of 3 joints have motors",
                "Joints:",
                "  joint l: slider, from 0 to 0.04 m, effort 20 N, speed 0.2 m/s",
                "  joint r: slider, from 0 to 0.04 m, follows: 2 * l + 0.01",
                "  joint hinge: hinge, effort 3 N m, speed 1.5 rad/s",
                "Modules:",
                "  module joints (joints): l, hinge",
                "  module pose (pose)"])

    LOSES = MODEL.replace("</robot>", '<gazebo><plugin filename="libfoo.so" name="f"/></gazebo></robot>')

    def test_the_exit_code_tells_what_runs_what_loses_and_what_does_not_run(self):
        with tempfile.TemporaryDirectory() as folder:
            texts = {"runs.urdf": self.MODEL, "loses.urdf": self.LOSES, "wrong.urdf": "<robot name='r'></robot>"}
            for name, text in texts.items():
                (Path(folder) / name).write_text(text)
            for names, code in ((["runs.urdf"], 0), (["loses.urdf"], 2), (["wrong.urdf"], 1), (["loses.urdf", "runs.urdf"], 2),
                                (["wrong.urdf", "loses.urdf"], 1)):
                done = run("check", *names, cwd=folder)
                self.assertEqual(done.returncode, code, (names, done.stdout, done.stderr))
            done = run("check", "--digests", "loses.urdf", cwd=folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("robot model", json.loads(done.stdout))

    def test_own_models_and_scenarios_run_or_do_not(self):
        with tempfile.TemporaryDirectory() as folder:
            robot = Path(__file__).parents[2] / "robots" / "lwa" / "model.sdf"
            (Path(folder) / "own.sdf").write_text(robot.read_text().replace("</model>", '<plugin filename="libfoo.so" name="f"/></model>'))
            done = run("check", "own.sdf", cwd=folder)
            self.assertIn("not used by coopdyn", done.stderr.decode())
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_json_is_an_object_a_line_and_keeps_the_diagnostics_on_stderr(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "loses.urdf").write_text(self.LOSES)
            done = run("check", "--json", "loses.urdf", "classroom", cwd=folder)
            reports = [json.loads(line) for line in done.stdout.decode().splitlines()]
            self.assertEqual([one["verdict"] for one in reports], ["runs with losses", "runs"])
            self.assertEqual([one["format"] for one in reports], ["URDF", "scenario"])
            self.assertIn("loses.urdf:13: warning: plug-in 'libfoo.so' is not used by coopdyn\n", done.stderr.decode())
            self.assertEqual(run("check", "--json", "--digests", "classroom").returncode, 2)

    def test_a_picture_of_a_model_shows_its_joints(self):
        with tempfile.TemporaryDirectory() as folder:
            fixed = self.MODEL.replace('type="prismatic"', 'type="fixed"').replace('type="continuous"', 'type="fixed"')
            pictures = []
            for name, text in (("a", self.MODEL), ("b", re.sub("<mimic[^>]*>", "", fixed))):
                (Path(folder) / f"{name}.urdf").write_text(text)
                done = run("check", f"{name}.urdf", "--picture", f"{name}.png", cwd=folder)
                self.assertEqual(done.returncode, 0, done.stderr)
                pictures.append((Path(folder) / f"{name}.png").read_bytes())
            self.assertNotEqual(*pictures)

    def test_a_world_of_the_search_path_has_its_page_by_its_bare_name(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "lab.sdf").write_text('<sdf version="1.9"><world name="lab"><wind/></world></sdf>')
            done = run("check", "lab", "--scenarios", folder)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn("there is no wind here", done.stdout.decode())
            self.assertIn(f"coopdyn serve lab --scenarios {folder}", done.stdout.decode())

    def test_ten_thousand_joints_are_a_page(self):
        with tempfile.TemporaryDirectory() as folder:
            box = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>'
            parts = [f'<link name="l{i}">{box}</link>' for i in range(10_001)]
            parts += [f'<joint name="j{i}" type="continuous"><parent link="l0"/><child link="l{i}"/><axis xyz="0 0 1"/></joint>'
                      for i in range(1, 10_001)]
            (Path(folder) / "a.urdf").write_text(f'<robot name="a">{"".join(parts)}</robot>')
            done = run("check", "a.urdf", cwd=folder)
            self.assertLessEqual(len(done.stdout.decode().splitlines()), 50)
            self.assertEqual(done.returncode, 1)  # a model has at most 300 links


if __name__ == "__main__":
    unittest.main()

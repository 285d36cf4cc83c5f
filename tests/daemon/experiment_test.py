# SPDX-License-Identifier: MIT
"""YARS experiments: an XML file is served, checked, recorded, sent over a socket and converted."""
import json
import math
import re
import tempfile
import unittest
from pathlib import Path

from harness import Daemon
from recording import RecordingTestCase, equal_steps, rows, tool

SCENARIOS = Path(__file__).parents[2] / "scenarios"
NAMES = ("braitenberg", "double_pendulum", "lightseeker")
EXAMPLES = ("dog", "octavio4", "octavio6", "octavio8", "runbot", "seeker", "soccer")  # yars_examples_test.py runs them
STEPS = 200  # in 2 s

# A crate and a ball at positions that depend on the seed, and a robot driven by clients.
EXPERIMENT = """<?xml version="1.0"?>
<rosiml version="1.0">
  <simulator frequency="100" mode="free" seed="5"/>
  <environment>
    <ground width="10" depth="10"/>
    <sphere name="ball" radius="0.1" mass="0.3">
      <pose z="0.1"/>
      <randomise x="-4 4" y="-4 4"/>
    </sphere>
  </environment>
  <movables>
    <movable name="arm" type="active">
      <body>
        <object name="base" mass="0"><pose z="1"/><box width="0.2" depth="0.2" height="0.2"/></object>
        <object name="bar" mass="0.5"><pose z="0.6"/><box width="0.05" depth="0.05" height="0.5"/></object>
        <connector name="swing" type="hinge" source="base" destination="bar">
          <pose z="-0.1" gamma="90"/>
          <drive type="position" maxForce="20" maxVelocity="3"/>
        </connector>
      </body>
    </movable>
  </movables>
</rosiml>
"""


# A ball on a slider without a motor, whose axis points down: it can fall half a metre.
FALL = """<rosiml version="0.8.41">
  <simulator frequency="1000"/>
  <robots>
    <robot name="tower">
      <body>
        <box name="top"><dimension width="0.1" depth="0.1" height="0.1"/><pose z="2"/><physics><mass kg="0"/></physics></box>
        <sphere name="ball"><dimension radius="0.1"/><pose x="0.5" z="1.5"/><physics><mass kg="0.1"/></physics></sphere>
      </body>
      <actuators>
        <slider name="rail" type="positional" mode="passive">
          <source name="top"/>
          <destination name="ball"/>
          <force max="0"/>
          <velocity max="0"/>
          <pose beta="90"/>
          <deflection min="-0.1" max="0.5"/>
        </slider>
      </actuators>
      <sensors>
        <oav name="imu"><object name="ball"/></oav>
      </sensors>
    </robot>
  </robots>
</rosiml>
"""


# A box joined to the world by a joint of two axes: it may fall, and turns about the vertical.
HANGING = """<rosiml version="0.8.41">
  <simulator frequency="100"/>
  <robots>
    <robot name="box">
      <body>
        <box name="all"><dimension width="0.1" depth="0.1" height="0.1"/><pose z="1"/><physics><mass kg="0.5"/></physics></box>
      </body>
      <actuators>
        <generic name="hold">
          <source name="all"/>
          <pose/>
          <rotational>
            <z type="velocity" mode="active"><force max="5"/><velocity max="2"/><deflection min="1" max="-1"/></z>
          </rotational>
          <translational>
            <z type="positional" mode="passive"><force max="0"/><velocity max="0"/><deflection min="-2" max="2"/></z>
          </translational>
        </generic>
      </actuators>
    </robot>
  </robots>
</rosiml>
"""


class ExperimentTest(RecordingTestCase):
    def setUp(self):
        super().setUp()
        self.xml = self.folder / "swing.xml"
        self.xml.write_text(EXPERIMENT)

    def run_hash(self, scenario, *options):
        """The hash of the state after some steps without clients."""
        summary = self.folder / "summary.json"
        with Daemon(None, "--mode", "free", "--duration", "2", "--no-render", "--summary", str(summary), *options,
                    name=str(scenario)) as daemon:
            daemon.process.wait()
        return json.loads(summary.read_text())["hash"]

    def test_it_is_served_and_its_robot_driven(self):
        with Daemon(None, name=str(self.xml)) as daemon:
            joints = daemon.text("/arm/joints")
            joints.must("set_positions 0.5")
            self.assertEqual(daemon.status()["scenario"], "swing")

    def test_it_is_found_by_its_bare_name(self):
        with Daemon(None, "--scenarios", str(self.folder), name="swing") as daemon:
            self.assertEqual(daemon.status()["scenario"], "swing")

    def test_its_recording_has_the_xml_and_verifies(self):
        self.run_hash(self.xml, "--record", str(self.file))
        self.assertEqual(equal_steps(self.file), STEPS)
        self.assertEqual(rows(self.file, "SELECT content FROM text WHERE kind = 'scenario'"), [(EXPERIMENT,)])

    def test_each_seed_has_a_world_of_its_own(self):
        self.assertNotEqual(self.run_hash(self.xml, "--seed", "1"), self.run_hash(self.xml, "--seed", "2"))
        self.assertEqual(self.run_hash(self.xml, "--seed", "2"), self.run_hash(self.xml, "--seed", "2"))

    def test_a_setting_changes_it_and_its_recording_verifies(self):
        self.run_hash(self.xml, "--set", "ball.mass=2", "--record", str(self.file))
        self.assertEqual(equal_steps(self.file), STEPS)
        (text,), = rows(self.file, "SELECT content FROM text WHERE kind = 'scenario'")
        self.assertTrue(text.endswith("[SET]\nball.mass 2\n"), text[-100:])

    def test_it_is_loaded_over_a_socket(self):
        with Daemon() as daemon:
            simulation = daemon.text("/simulation")
            simulation.must("load_scenario " + json.dumps(EXPERIMENT))
            daemon.text("/arm/joints").must("get_joints")

    def test_it_is_loaded_from_a_file_by_the_command_line(self):
        with Daemon() as daemon:
            code, said = tool("load", self.xml, "--server", "127.0.0.1:%d" % daemon.names[1])
            self.assertEqual(code, 0, said)
            self.assertEqual(daemon.status()["scenario"], "swing")

    def test_a_reload_reads_the_edited_file(self):
        with Daemon(None, name=str(self.xml)) as daemon:
            self.xml.write_text(EXPERIMENT.replace('movable name="arm"', 'movable name="leg"'))
            daemon.text("/simulation").must("reload")
            daemon.text("/leg/joints").must("get_joints")

    def test_a_saved_world_names_its_robot_and_loads_again(self):
        saved = self.folder / "saved.scenario"
        with Daemon(None, name=str(self.xml)) as daemon:
            code, said = tool("world", "save", saved, "--server", "127.0.0.1:%d" % daemon.names[1])
            self.assertEqual(code, 0, said)
        self.assertIn(f'type "{self.xml}#arm"', saved.read_text())
        code, said = tool("check", saved)
        self.assertEqual(code, 0, said)

    def test_a_reset_with_a_seed_draws_anew(self):
        with Daemon(None, name=str(self.xml)) as daemon:
            simulation = daemon.text("/simulation")
            hashes = []
            for seed in (8, 9, 8):
                simulation.must("pause")
                simulation.must(f"reset {seed}")
                hashes.append(daemon.status()["hash"])
            self.assertEqual(hashes[0], hashes[2])
            self.assertNotEqual(hashes[0], hashes[1])

    def test_a_slider_without_a_motor_falls_to_its_stop(self):
        self.xml.write_text(FALL)
        with Daemon(None, "--mode", "free", name=str(self.xml)) as daemon:
            simulation, imu = daemon.text("/simulation"), daemon.text("/tower/imu")
            simulation.must("pause")
            simulation.must("reset 1")
            stop = math.sqrt(2 * 0.5 / 9.81)  # s
            simulation.must(f"step {int(1000 * stop) - 5}")
            self.assertAlmostEqual(imu.must("get_imu").data[9], 0, delta=0.01)
            simulation.must("step 100")
            self.assertAlmostEqual(imu.must("get_imu").data[9], 9.81, delta=0.01)

    def test_the_pose_of_what_hangs_on_the_world_is_that_of_its_body(self):
        self.xml.write_text(HANGING)
        with Daemon(None, "--mode", "free", name=str(self.xml)) as daemon:
            simulation, pose = daemon.text("/simulation"), daemon.text("/box/pose")
            simulation.must("pause")
            simulation.must("reset 1")
            before = pose.must("get_pose_3d").data
            self.assertEqual(before[:3], [0, 0, 0])
            daemon.text("/box/joints").must("set_velocities 1")
            simulation.must("step 30")
            x, y, z, *_ = now = pose.must("get_pose_3d").data
            self.assertAlmostEqual(z, -9.81 * 0.3**2 / 2, delta=0.02)
            self.assertAlmostEqual(now[9], -9.81 * 0.3, delta=0.05)
            self.assertAlmostEqual(abs(pose.must("get_pose").data[2]), 0.3, delta=0.02)

    def test_check_says_all_mistakes_with_their_lines(self):
        self.xml.write_text(EXPERIMENT.replace('frequency="100"', 'frequncy="100"').replace('radius="0.1"', 'radius="-1"'))
        code, said = tool("check", self.xml)
        self.assertEqual(code, 1)
        self.assertIn("swing.xml:3: error: unknown attribute 'frequncy' in <simulator>; did you mean 'frequency'?", said)
        self.assertIn("swing.xml:6: error: 'radius' in <sphere> is a number above 0, not '-1'", said)

    def test_what_the_models_reader_refuses_is_said_at_the_line_of_the_xml(self):
        self.xml.write_text(EXPERIMENT.replace('mass="0.5"', 'mass="1e-9"'))
        code, said = tool("check", self.xml)
        self.assertEqual(code, 1)
        self.assertRegex(said, r"^\S+swing\.xml:15: error: robot 'arm': [^\n]*\n$")

    def test_garbage_is_an_error(self):
        self.xml.write_bytes(b"\xff\xfe<rosiml" * 1000)
        self.assertEqual(tool("check", self.xml)[0], 1)
        self.xml.write_text("<!DOCTYPE a [<!ENTITY b 'bb'>]><rosiml version='1'>&b;</rosiml>")
        code, said = tool("check", self.xml)
        self.assertEqual(code, 1)
        self.assertIn("a DOCTYPE and entities are not read", said)


# A wedge joined to the world by a joint of six axes; its mesh is beside the XML.
WEDGE = """<rosiml version="0.8.41">
  <simulator frequency="100"/>
  <robots>
    <robot name="wedge">
      <body>
        <ply name="all" filename="ply/wedge.ply" convex="true"><pose z="1"/><physics><mass kg="0.5"/></physics></ply>
      </body>
      <actuators>
        <generic name="hold" spring="true">
          <source name="all"/>
          <pose/>
          <rotational>
            <z type="angular" mode="active"><force max="5"/><velocity max="2"/><deflection min="-90" max="90"/></z>
          </rotational>
          <translational>
            <z type="positional" mode="passive"><force max="0"/><velocity max="0"/><deflection min="-1" max="1"/>
              <spring stiffness="40" damping="4"/></z>
          </translational>
        </generic>
      </actuators>
    </robot>
  </robots>
</rosiml>
"""
PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar uint vertex_indices
end_header
-0.1 -0.1 -0.1
0.1 -0.1 -0.1
0 0.1 -0.1
0 0 0.1
3 0 2 1
3 0 1 3
3 1 2 3
3 2 0 3
"""


class MeshTest(RecordingTestCase):
    run_hash = ExperimentTest.run_hash

    def setUp(self):
        super().setUp()
        self.xml = self.folder / "wedge.xml"
        self.xml.write_text(WEDGE)
        self.mesh = self.folder / "ply" / "wedge.ply"
        self.mesh.parent.mkdir()
        self.mesh.write_text(PLY)

    def test_a_mesh_hangs_on_the_spring_of_a_joint_with_several_axes(self):
        with Daemon(None, "--mode", "free", name=str(self.xml)) as daemon:
            simulation, joints = (daemon.text(f"/{name}") for name in ("simulation", "wedge/joints"))
            simulation.must("pause")
            simulation.must("reset 1")
            joints.must("set_positions 0.5")
            simulation.must("step 500")
            self.assertAlmostEqual(joints.must("get_joints").data[0], 0.5, delta=1e-3)

    def test_a_recording_needs_the_file_no_more(self):
        self.run_hash(self.xml, "--record", str(self.file))
        self.mesh.unlink()
        self.assertEqual(equal_steps(self.file), STEPS)

    def test_a_converted_one_has_its_mesh_and_runs_alike(self):
        out = self.folder / "out"
        code, said = tool("convert", self.xml, "--out", out)
        self.assertEqual(code, 0, said)
        self.assertEqual(self.run_hash(self.xml), self.run_hash(out / "wedge.scenario"))

    def test_a_missing_file_is_an_error_with_its_line(self):
        self.mesh.unlink()
        code, said = tool("check", self.xml)
        self.assertEqual(code, 1)
        self.assertRegex(said, r"wedge\.xml:6: error: robot 'wedge': mesh: there is no 'ply/wedge\.ply'")

    def test_over_a_socket_no_file_is_read(self):
        with Daemon() as daemon:
            reply = daemon.text("/simulation").ask("load_scenario " + json.dumps(WEDGE + f"# file: {self.xml}\n"))
            self.assertIn("is a file, and this model came without", reply.text)


class ConvertTest(RecordingTestCase):
    run_hash = ExperimentTest.run_hash

    def test_a_converted_experiment_runs_alike(self):
        for name in NAMES:
            with self.subTest(name):
                out = self.folder / name
                code, said = tool("convert", SCENARIOS / f"{name}.xml", "--out", out)
                self.assertEqual(code, 0, said)
                self.assertEqual(self.run_hash(SCENARIOS / f"{name}.xml"), self.run_hash(out / f"{name}.scenario"))

    def test_nothing_that_is_there_is_overwritten(self):
        out = self.folder / "out"
        self.assertEqual(tool("convert", "lightseeker", "--out", out)[0], 0)
        for gone in (None, out / "lightseeker.scenario"):
            if gone:
                gone.unlink()
            code, said = tool("convert", "lightseeker", "--out", out)
            self.assertEqual(code, 1)
            self.assertIn("is there already", said)

    def test_an_experiment_with_mistakes_is_not_converted(self):
        xml = self.folder / "wrong.xml"
        xml.write_text("<rosiml version='1'><movabels/></rosiml>")
        code, said = tool("convert", xml, "--out", self.folder / "out")
        self.assertEqual(code, 1)
        self.assertIn("did you mean 'movables'?", said)
        self.assertFalse((self.folder / "out").exists())


class ShippedTest(unittest.TestCase):
    def test_positive_speeds_of_two_wheels_drive_ahead(self):
        with Daemon(None, "--mode", "lockstep", name="lightseeker") as daemon:
            motors, pose = daemon.text("/seeker/motors"), daemon.text("/seeker/pose")
            motors.must("set_velocity 0.2 0")
            motors.must("ready 199")
            x, y, heading = pose.must("get_pose").data[:3]
            self.assertAlmostEqual(heading, math.radians(20), delta=1e-3)
            self.assertAlmostEqual(math.atan2(y, x + 2), heading, delta=1e-2)
            self.assertAlmostEqual(math.hypot(x + 2, y), 0.4, delta=0.01)

    def test_the_example_of_the_manual_is_right(self):
        text = (SCENARIOS.parent / "docs" / "yars.md").read_text()
        with tempfile.TemporaryDirectory() as folder:
            xml = Path(folder) / "manual.xml"
            xml.write_text(re.search(r"```xml\n(.*?)```", text, re.S).group(1))
            code, said = tool("check", xml)
            self.assertEqual(code, 0, said)
            self.assertNotIn("warning", said)

    def test_every_shipped_experiment_is_right(self):
        names = sorted(path.stem for path in SCENARIOS.glob("*.xml"))
        self.assertEqual(names, sorted(NAMES + EXAMPLES))
        for name in names:
            code, said = tool("check", name)
            self.assertEqual(code, 0, said)
            self.assertNotIn("warning", said)


if __name__ == "__main__":
    unittest.main()

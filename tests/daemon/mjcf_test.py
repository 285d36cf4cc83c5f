# SPDX-License-Identifier: MIT
"""MuJoCo model files: serves, records and converts one. Skipped if coopdyn-mjcf was not built."""
import contextlib
import json
import os
import signal
import subprocess
import sys
import unittest
import urllib.request
from pathlib import Path

from harness import BINARY, Daemon, until
from recording import RecordingTestCase, equal_steps, tool

STEPS = 200

MODEL = """<mujoco model="pup">
  <option timestep="0.005"/>
  <asset><mesh name="wedge" vertex="0 0 0  .2 0 0  0 .2 0  0 0 .2"/></asset>
  <worldbody>
    <geom type="plane" size="5 5 1"/>
    <body name="trunk" pos="0 0 .5" euler="90 90 90">
      <freejoint/>
      <geom type="mesh" mesh="wedge"/>
      <body name="leg" pos="0 0 -.1">
        <joint name="hip" axis="0 1 0" range="-60 60" damping=".1"/>
        <geom type="capsule" size=".03" fromto="0 0 0 0 0 -.2"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="hip" ctrlrange="-5 5"/></actuator>
</mujoco>
"""


def has_ended(process):
    try:
        return "State:\tZ" in Path(f"/proc/{process}/status").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return True


@unittest.skipUnless(Path(BINARY).with_name("coopdyn-mjcf").exists(), "libmujoco-dev was not there when coopdyn was built")
class MjcfTest(RecordingTestCase):
    def setUp(self):
        super().setUp()
        self.model = self.folder / "pup.xml"
        self.model.write_text(MODEL)

    def run_hash(self, world, *options):
        """The hash of the state after a second without clients."""
        summary = self.folder / "summary.json"
        with Daemon(None, "--mode", "free", "--duration", "1", "--no-render", "--summary", str(summary), *options,
                    name=str(world)) as daemon:
            daemon.process.wait()
        return json.loads(summary.read_text())["hash"]

    def test_its_robot_is_driven(self):
        with Daemon(None, "--mode", "free", name=str(self.model)) as daemon:
            simulation, joints = (daemon.text(f"/{name}") for name in ("simulation", "pup/joints"))
            simulation.must("pause")
            simulation.must("reset 1")
            joints.must("set_positions 0.5")
            simulation.must("step 400")
            self.assertAlmostEqual(joints.must("get_joints").data[0], 0.5, delta=0.01)

    def test_a_recording_needs_the_file_no_more(self):
        self.run_hash(self.model, "--record", str(self.file))
        self.model.unlink()
        self.assertEqual(equal_steps(self.file), STEPS)

    def test_a_converted_one_runs_alike(self):
        out = self.folder / "out"
        code, said = tool("convert", self.model, "--out", out)
        self.assertEqual(code, 0, said)
        self.assertTrue((out / "meshes" / "wedge.stl").exists())
        self.assertEqual(self.run_hash(self.model), self.run_hash(out / "pup.sdf"))
        code, said = tool("convert", self.model, "--out", out)
        self.assertEqual(code, 1)
        self.assertIn("is there already: name another folder with --out", said)

    def test_a_file_among_the_uploads_is_refused_whoever_put_it_there(self):
        with Daemon(None, "--http", "--no-render", env={"TMPDIR": str(self.folder)}) as daemon:
            arm = json.dumps({"name": "arm.urdf", "text": '<robot name="arm"><link name="base"/></robot>'}).encode()
            urllib.request.urlopen(urllib.request.Request(f"{daemon.http}api/upload", arm, {"Content-Type": "application/json"}))
            arm = next(self.folder.glob("coopdyn-*/robots/arm/model.urdf"))
            other = arm.parents[1] / "pup" / "model.sdf"
            other.parent.mkdir()
            other.write_text(MODEL)
            reply = daemon.text("/simulation").ask("load_scenario " + json.dumps("[ROBOT_1]\ntype pup\nposition 0 0\n"))
            self.assertIn("MuJoCo's files that are sent are not read here", reply.text)

    def test_the_program_that_reads_it_has_limits_and_ends_with_whoever_started_it(self):
        pipe = self.folder / "pipe.xml"
        os.mkfifo(pipe)
        words = [str(Path(BINARY).resolve().with_name("coopdyn-mjcf")), str(pipe), str(self.folder / "meshes"), "m/"]
        starter = subprocess.Popen([sys.executable, "-c", "import subprocess, sys; p = subprocess.Popen(sys.argv[1:]); "
                                    "print(p.pid, flush=True); p.wait()", *words], stdout=subprocess.PIPE)
        with starter:
            reader = int(starter.stdout.readline())
            with contextlib.ExitStack() as end, open(pipe, "wb"):  # it reads now, and waits
                end.callback(lambda: has_ended(reader) or os.kill(reader, signal.SIGKILL))
                limits = Path(f"/proc/{reader}/limits").read_text()
                self.assertRegex(limits, rf"Max file size +{1 << 30} +{1 << 30} ")
                self.assertRegex(limits, r"Max cpu time +60 +60 ")
                starter.kill()
                starter.wait()
                until(lambda: has_ended(reader))

    def test_a_scenario_has_it_as_a_robot(self):
        scenario = self.folder / "two.scenario"
        scenario.write_text("[FLOOR]\nsize 10 10\n[ROBOT_1]\ntype pup.xml\nposition 0 0\n"
                            "[ROBOT_2]\ntype pup.xml#pup\nposition 2 0 1\n")
        code, said = tool("check", scenario)
        self.assertEqual(code, 0, said)
        self.assertIn("2 robots", said)


if __name__ == "__main__":
    unittest.main()

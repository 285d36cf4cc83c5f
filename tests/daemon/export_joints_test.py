"""The joints of a run in `coopdyn export` and `info`: of arms, and of robots with wheels and several groups."""
import csv
import math
import subprocess
import unittest

from harness import LIMIT_S, Daemon
from recording import Play, RecordingTestCase, tool

WORLD = """[SIMULATION]
mode lockstep
[FLOOR]
size 20 20 0.1
[ROBOT_1]
type lwa
name arm1
position 0 0
[ROBOT_2]
type mobile_arm
name both1
position 4 0
"""
ARM = [f"joint_{k}" for k in range(1, 8)]

OCTAVE = r"""
load("run.mat");
arm = run.robots(1);
both = run.robots(2);
assert(isequal(arm.joints, {"joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6", "joint_7"}));
assert(isequal(size(arm.channels), [numel(run.time), 14]));
assert(arm.channels(end, 2) > 0.1 && arm.channels(end, 2) < 0.5);   # positions first
assert(max(arm.channels(:, 9)) > 0.1);                              # then velocities
assert(isequal(arm.setpoints(end, [1 2]), [0.25 0.5]) && isequal(arm.modes(end, [1 2]), [3 1]));
wheel = strncmp(both.joints, "joint_", 6) == 0;
assert(sum(wheel) == 2 && sum(~wheel) == 6);
n = numel(both.joints);
assert(all(both.channels(end, n + find(wheel)) > 0.5));
assert(isequal(both.modes(end, wheel), [3 3]) && isequal(both.modes(end, find(~wheel)(1)), 2));
printf("read\n");
"""


class ExportJointsTest(RecordingTestCase):
    def setUp(self):
        super().setUp()
        with Daemon(WORLD, "--record", str(self.folder / "run.run")) as daemon:
            arm, wheels, other = (daemon.text(name) for name in ("/arm1/arm", "/both1/motors", "/both1/arm"))
            for k in range(40):
                arm.send("set_positions (2) 0.5" if k == 0 else "set_velocities (1) 0.25")
                wheels.send("set_velocity 0.1 0")
                other.send(f"set_positions_direct (1) {0.001 * k}")
                for module in (arm, wheels, other):
                    assert module.receive().error == 0
            self.last = arm.must("get_joints").data

    def test_a_table_has_position_velocity_setpoint_and_mode_of_each_joint_by_name(self):
        code, said = tool("export", "run.run", "--to", "csv", cwd=self.folder)
        self.assertEqual(code, 0, said)
        with open(self.folder / "run.csv", newline="") as file:
            table = list(csv.DictReader(file))
        for k, joint in enumerate(ARM):
            self.assertAlmostEqual(float(table[40][f"arm1.{joint}_rad"]), self.last[3 * k], delta=1e-5)
            self.assertAlmostEqual(float(table[40][f"arm1.{joint}_rad_s"]), self.last[3 * k + 1], delta=1e-3)
        self.assertEqual((table[40]["arm1.joint_1_setpoint_rad_s"], table[40]["arm1.joint_1_mode"]), ("0.25", "3"))
        self.assertEqual((table[40]["arm1.joint_2_setpoint"], table[40]["arm1.joint_2_mode"]), ("0.5", "1"))
        self.assertEqual(table[40]["both1.joint_1_mode"], "2")
        self.assertEqual(len([name for name in table[0] if name.startswith("both1.") and name.endswith("_mode")]), 8)

    def test_a_playback_tells_modes_targets_and_arrival(self):
        with Play(str(self.folder / "run.run"), "--paused") as daemon:
            arm, playback = daemon.text("/arm1/arm"), daemon.text("/playback")
            playback.must("seek 0.4")
            self.assertEqual(arm.must("get_modes (1 2)").params, [3, 1])
            motion = arm.must("get_motion (2)")
            self.assertEqual((motion.params, motion.data[0]), ([0], 0.5))
            self.assertTrue(math.isnan(arm.must("get_references (2)").data[0]))
            self.assertEqual(arm.must("get_references (1)").data[0], 0.25)

    def test_octave_reads_the_joints(self):
        code, said = tool("export", "run.run", "--to", "mat", cwd=self.folder)
        self.assertEqual(code, 0, said)
        (self.folder / "read.m").write_text("1;\n" + OCTAVE)
        done = subprocess.run(["octave-cli", "--norc", "--quiet", "read.m"], cwd=self.folder, capture_output=True, text=True,
                              timeout=2 * LIMIT_S)
        self.assertEqual((done.returncode, done.stdout), (0, "read\n"), done.stderr)


if __name__ == "__main__":
    unittest.main()

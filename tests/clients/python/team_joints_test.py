# SPDX-License-Identifier: MIT
"""Teams of robots of different kinds: joints, several kinds of commands in one step, rows of different lengths."""
import math
import pathlib
import unittest

import harness
from cases import DaemonTestCase

SCENARIO = (pathlib.Path(__file__).parent / "kinds.scenario").read_text(encoding="utf-8")
BENT = [0, 0.8, 0, 0.8, 0, 0.8, 0]


class TeamJoints(DaemonTestCase):
    options = ("--no-http", "--no-render")

    def setUp(self):
        self.sim = self.connect(self.start(SCENARIO))

    def team(self, *names):
        """A team of these robots; the others stand still."""
        self.sim.set_participants(names)
        return self.sim.team(names)

    def test_wheels_and_arms_of_different_robots_move_in_the_same_steps(self):
        team = self.team("wheels1", "arm1", "both1")
        team.select("pose", "joints")
        before = team.read()
        nan = math.nan
        for _ in range(150):
            s = team.step({"velocities": [[0.2, 0], [nan, nan], [0.1, 0]],
                           "positions": [[], BENT, [0.3] * 6]}, timeout=60)
        self.assertAlmostEqual(s.pose[0][0] - before.pose[0][0], 0.3, delta=0.02)
        self.assertAlmostEqual(s.pose[2][0] - before.pose[2][0], 0.15, delta=0.02)
        self.assertTrue(math.isnan(s.joints[0][0]))
        self.assertAlmostEqual(s.joints[1][3], 0.8, delta=0.3)  # position, velocity, effort of joint 1, then of joint 2
        for k in range(6):
            self.assertAlmostEqual(s.joints[2][3 * k], 0.3, places=2)
        self.assertEqual(self.sim.robot("both1").joints("arm").get().position, list(s.joints[2][0:18:3]))

    def test_groups_of_one_robot_get_commands_of_different_kinds_in_one_step(self):
        team = self.team("human1")
        human = self.sim.robot("human1")
        waist = human.joints("waist").get_modes()
        team.step({"positions/left_arm": [0.1, 0.2, 0, -0.3], "joint_velocities/neck": [[0.2, 0]],
                   "efforts/right_arm": [0.5, 0, 0, 0]}, timeout=60)
        self.assertEqual(human.joints("left_arm").get_modes(), ["position"] * 4)
        self.assertEqual(human.joints("left_arm").get_motion().target, [0.1, 0.2, 0, -0.3])
        self.assertEqual(human.joints("neck").get_modes(), ["velocity"] * 2)
        self.assertEqual(human.joints("neck").get_references(), [0.2, 0])
        self.assertEqual(human.joints("right_arm").get_modes(), ["effort"] * 4)
        self.assertEqual(human.joints("right_arm").get_references()[0], 0.5)
        self.assertEqual(human.joints("waist").get_modes(), waist)

    def test_nan_leaves_a_joint_as_it_is(self):
        team = self.team("arm1")
        arm = self.sim.robot("arm1").joints()
        team.step({"joint_velocities": [0.1] * 7}, timeout=60)
        team.step({"positions_direct": [0.0] + [math.nan] * 6}, timeout=60)
        self.assertEqual(arm.get_modes(), ["direct"] + ["velocity"] * 6)

    def test_a_reference_beyond_the_limits_is_cut_and_said(self):
        team = self.team("arm1")
        self.assertEqual(team.step({"positions": [0, 99, 0, 0, 0, 0, 0]}, timeout=60).text, "limited 1 robot")

    def test_what_does_not_fit_says_what_to_write(self):
        team = self.team("wheels1", "both1")
        self.assert_error(4, lambda: team.step({"position": [0]}), "positions_direct")
        self.assert_error(3, lambda: team.step({}), "positions")
        self.assert_error(3, lambda: team.step({"positions": [[0] * 6] * 3}), "3 rows", "2 robots")
        self.assert_error(3, lambda: team.step({"positions": "far"}), "one row of numbers")
        self.assert_error(4, lambda: team.step({"positions": [math.inf] * 6}), "finite")
        self.assert_error(3, lambda: team.step({"velocities": [0, 0], "positions": [0] * 5}), "velocities 2, positions 6")
        self.assert_error(10, lambda: team.step({"positions/leg": [0]}), "positions/leg", "arm")
        self.assert_error(2, lambda: team.step({"positions": [0] * 6, "efforts/arm": [0] * 6}), "second command")
        self.assert_error(2, lambda: team.step({"velocities": [0, 0], "wheels": [0, 0]}), "second command")
        self.assert_error(4, lambda: team.step({"velocities": [[0.1, math.nan]], "positions": [0] * 6}), "finite")
        self.assertEqual(self.sim.steps, 0)


if __name__ == "__main__":
    unittest.main()

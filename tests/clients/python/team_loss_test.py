# SPDX-License-Identifier: MIT
"""A team that loses robots, to other programs or by another scenario, against the real daemon."""
import unittest

from cases import DaemonTestCase
from harness import swarm_of

LONG_S = 60


class LossTestCase(DaemonTestCase):
    options = ("--no-http", "--no-render")


class Emptied(LossTestCase):
    def test_a_team_without_robots_takes_none_from_its_successor(self):
        daemon = self.start(swarm_of(6))
        others = self.connect(daemon, name="C")
        sim = self.connect(daemon, name="A")
        first = sim.team("mini")
        first.step(timeout=LONG_S)
        others.pause()
        others.load_scenario("classroom")
        others.load_scenario("swarm100")
        said = self.assert_error(5, first.read, "scenario swarm100 was loaded")
        self.assertIn("catch this to start over", said)
        others.run()
        second = sim.team("swarm1")
        second.step(timeout=LONG_S)
        others.pause()
        self.assert_error(11, lambda: second.step(timeout=0.1))
        others.run()
        self.assertEqual(second.read().pose.shape[0], 100)
        second.step(timeout=LONG_S)
        self.assertEqual(sim.team("swarm1").step(timeout=LONG_S).pose.shape[0], 100)


class TakenAway(LossTestCase):
    def setUp(self):
        daemon = self.start(swarm_of(6, mode="realtime"))
        self.sim, self.other = self.connect(daemon, name="A"), self.connect(daemon, name="B")
        self.team = self.sim.team("swarm1")
        self.team.step((0.1, 0), timeout=LONG_S)

    def lose(self):
        """Frees the robot by hand, and makes another program drive it."""
        self.other.call("simulation", "release_robot", text="mini_5")
        self.other.robot("mini_5").set_velocity(0, 0.5)

    def test_one_row_for_all_goes_on_with_the_rest(self):
        self.lose()
        s = self.team.step((0.1, 0), timeout=LONG_S)
        self.assertEqual((len(s.pose), self.team.n), (5, 5))
        self.assertNotIn("mini_5", self.team.names)

    def test_a_row_for_each_is_refused_and_says_whom_it_lost(self):
        self.lose()
        for _ in range(2):
            self.assert_error(3, lambda: self.team.step([(0.1, 0)] * 6, timeout=LONG_S),
                              "team swarm1 has lost mini_5: V must have 5 rows now")
        self.team.step([(0.1, 0)] * 5, timeout=LONG_S)

    def test_after_a_timeout_the_rest_is_the_same_team(self):
        self.lose()
        self.sim.pause()
        self.assert_error(11, lambda: self.team.step(timeout=0.1))
        self.assertIn("free", self.assert_error(10, self.sim.team))
        self.sim.run()
        self.assertEqual(len(self.sim.team("swarm1").step((0.1, 0), timeout=LONG_S).pose), 5)

    def test_a_robot_of_ones_own_team_is_driven_there(self):
        self.assert_error(6, lambda: self.sim.team("mini_1"),
                          "robot mini_1 belongs to your team swarm1: drive it there, or release that team first")

    def test_a_team_of_many_names_is_told_by_its_size(self):
        self.team.release()
        team = self.sim.team([f"mini_{i}" for i in range(1, 7)])
        self.assert_error(6, lambda: self.sim.team("mini_2"), "robot mini_2 belongs to your team of 6 robots")
        team.release()
        self.assertNotIn("mini_4", self.assert_error(5, team.step))

    def test_names_and_readings_may_be_lists_and_nothing_else(self):
        self.team.select(["pose", "wheels"])
        self.assertEqual(self.team.read().wheels.shape, (6, 4))
        self.assert_error(4, lambda: self.team.select(3), "there is no reading 3")
        for wrong in (3, [1, 2]):
            self.assert_error(3, lambda: self.sim.team(wrong), 'sim.team("swarm1")')


if __name__ == "__main__":
    unittest.main()

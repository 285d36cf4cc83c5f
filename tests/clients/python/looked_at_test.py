# SPDX-License-Identifier: MIT
"""Robots that a program only reads: it claims them when it drives them or steps with them, if they are free."""
import os
import pathlib
import subprocess
import tempfile
import unittest

import harness  # noqa: F401  (finds coopdyn.py)
import coopdyn
from cases import DaemonTestCase


def record(folder, *options):
    """A run of mini_1 to mini_4, which nobody drives, and auto, driven by a loaded controller."""
    scenario, file = pathlib.Path(__file__).with_name("looked_at.scenario"), os.path.join(folder, "m.run")
    subprocess.run([os.environ["COOPDYN_BINARY"], "serve", scenario, "--mode", "free", "--no-net", "--duration", "0.8",
                    "--record", file, *options], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=60)
    return file


class LookedAt(DaemonTestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.file = record(folder.name)

    def setUp(self):
        self.daemon = self.start(self.file, "--paused")
        self.sim = self.connect(self.daemon, name="ana")

    def branch(self, mode="lockstep"):
        self.sim.branch(0.6)
        self.sim.set_mode(mode)
        self.sim.run()

    def owner(self, name):
        return next(r["owner"] for r in self.sim.status()["robots"] if r["name"] == name)

    def test_one_that_a_controller_drives_is_still_looked_at_after_a_branch(self):
        auto = self.sim.robot("auto")
        before = auto.get_pose()
        self.branch()
        team = self.sim.team("mini")
        for _ in range(5):
            self.sim.step(timeout=60)
        team.step((0.1, 0), timeout=60)
        self.assertEqual(self.sim.steps, 66)
        self.assertNotEqual(auto.get_pose(), before)
        self.assertEqual((auto.sense().step, auto.sense().pose), (66, auto.get_pose()))
        self.assertEqual(self.owner("auto"), "controller diffuse")
        self.assert_error(6, lambda: auto.set_velocity(0.1, 0), "controller diffuse", "watch=True")
        self.sim.step(timeout=60)
        self.sim.release_robot("auto")
        auto.set_velocity(0.1, 0)
        self.sim.step(timeout=60)
        self.assertEqual(self.owner("auto"), "ana")

    def test_one_that_somebody_else_drives_is_still_looked_at_after_a_branch(self):
        mini = self.sim.robot("mini_1")
        self.branch("realtime")
        other = self.connect(self.daemon, name="ben")
        other.robot("mini_1").set_velocity(0.1, 0)
        self.sim.step(2, timeout=60)
        self.assertEqual(self.owner("mini_1"), "ben")
        other.robot("mini_1").set_velocity(0.2, 0)
        self.sim.close()
        self.assertGreater(other.robot("mini_1").get_pose().forward, 0)
        self.assertEqual(mini.name, "mini_1")

    def test_one_that_is_free_after_a_branch_steps_with_the_program(self):
        robots = [self.sim.robot(f"mini_{k}") for k in range(1, 5)]
        self.branch()
        self.sim.step(3, timeout=60)
        self.assertEqual((self.sim.steps, self.owner("mini_3")), (63, "ana"))
        robots[2].set_velocity(0.1, 0)
        self.sim.step(timeout=60)
        self.assertGreater(robots[2].get_wheels().left_speed, 0)

    def test_a_team_takes_those_that_the_program_has_only_looked_at(self):
        mini = self.sim.robot("mini_4")
        self.branch()
        near = self.sim.robot("mini_2")
        self.assertEqual([r.get_pose().forward for r in (mini, near)], [0, 0])
        team = self.sim.team("mini")
        self.assertEqual(team.n, 4)
        for _ in range(3):
            team.step((0.1, 0), timeout=60)
        self.sim.step(timeout=60)
        self.assertGreater(mini.get_wheels().left_speed, 0)
        for r in (mini, near):
            self.assert_error(5, lambda: r.set_velocity(0.1, 0), f"{r.name} is driven by its team")
        team.release()
        for r in (mini, near, self.sim.robot("mini_1"), self.sim.robot("mini_3")):
            r.set_velocity(0.05, 0)
        self.sim.step(timeout=60)
        self.assertEqual([self.owner(f"mini_{k}") for k in range(1, 5)], ["ana"] * 4)

    def test_a_team_does_not_take_those_that_the_program_drives(self):
        self.branch()
        self.sim.robot("mini_4").set_velocity(0.1, 0)
        self.assert_error(6, lambda: self.sim.team("mini"), "mini_4 is driven by ana")

    def test_a_team_that_cannot_be_lets_them_be_driven(self):
        self.branch()
        mini = self.sim.robot("mini_1")
        other = self.connect(self.daemon, name="ben")
        other.robot("mini_3")
        self.assert_error(6, lambda: self.sim.team("mini"), "mini_3 is driven by ben")
        mini.set_velocity(0.1, 0)
        self.assertEqual(self.owner("mini_1"), "ana")


class CommandsOfControllers(unittest.TestCase):
    def test_those_that_were_not_recorded_are_an_error_that_says_so(self):
        with tempfile.TemporaryDirectory() as folder:
            run = coopdyn.read_run(record(folder, "--record-what", "poses"))
            with self.assertRaises(coopdyn.Error) as caught:
                run.commands("auto")
            self.assertEqual((caught.exception.code, caught.exception.text),
                             (5, f"the commands of auto, driven by controller diffuse, were not recorded in {run.file}; "
                                 "record with --record-what poses,controllers"))
            self.assertEqual(list(run.commands("mini_1")), [(0, 0, 0, 0, 3, 3)])

    def test_those_that_were_recorded_are_read(self):
        with tempfile.TemporaryDirectory() as folder:
            run = coopdyn.read_run(record(folder, "--record-what", "poses,controllers"))
            self.assertGreater(len(run.commands("auto")), 1)


if __name__ == "__main__":
    unittest.main()

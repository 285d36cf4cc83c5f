# SPDX-License-Identifier: MIT
"""Modules are found by their type: a model may rename them."""
import os
import tempfile
import unittest
from unittest import mock

import legs
from cases import DaemonTestCase


class ModuleNames(DaemonTestCase):
    def test_motors_called_legs_drive_and_a_compass_called_north_is_read(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        scenario = legs.make(folder.name)
        with mock.patch.dict(os.environ, COOPDYN_PATH=folder.name):
            with open(scenario, encoding="utf-8") as text:
                daemon = self.start(text.read())
        sim = self.connect(daemon)
        robot = sim.robot("robot1")
        robot.set_velocity(0.2, 0)
        sim.step(20)
        seen = robot.sense()
        self.assertGreater(seen.pose.x, 0)
        self.assertGreater(seen.wheels.left_speed, 1)
        self.assertEqual(robot.get_wheels(), seen.wheels)
        self.assertEqual(robot.get_compass(), seen.compass)
        self.assertEqual(robot.get_compass("north"), seen.compass)
        self.assertEqual(robot.call("motors", "get_wheels").data, robot.call("legs", "get_wheels").data)
        robot.subscribe("motors")
        sim.step()
        self.assertEqual(robot.next("motors", timeout=60).step, 21)
        self.assert_error(10, lambda: robot.get_compass("south"), "south")


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: MIT
"""Arms: the same program in lockstep and in real time, robots with several actuators, what is refused."""
import math
import unittest

from cases import DaemonTestCase

SCENARIO = """[SIMULATION]
mode {mode}
[FLOOR]
size 20 20 0.1
[ROBOT_1]
type lwa
name arm1
position 0 0
"""
BOTH = SCENARIO + """[ROBOT_2]
type mobile_arm
name m1
position 4 0
"""
BENT = [0, 0.8, 0, 0.8, 0, 0.8, 0]


class Joints(DaemonTestCase):
    def arm(self, scenario=SCENARIO, mode="lockstep"):
        sim = self.connect(self.start(scenario.format(mode=mode)))
        robot = sim.robot("arm1")
        return sim, robot, robot.joints()

    def move(self, sim, arm, *command):
        arm.set_positions(*command)
        self.assertFalse(arm.arrived())  # no step has run yet
        for _ in range(3000):
            sim.step()
            if arm.arrived():
                return
        self.fail("it did not arrive")

    def test_positions_are_reached_in_both_modes(self):
        sim, _, arm = self.arm()
        self.move(sim, arm, BENT)
        for here, there in zip(arm.get().position, BENT):
            self.assertAlmostEqual(here, there, places=3)
        sim.set_mode("realtime")
        self.move(sim, arm, 0.3, arm.names[2])
        self.assertAlmostEqual(arm.get(3).position[0], 0.3, places=3)
        self.assertAlmostEqual(arm.get("joint_2").position[0], 0.8, places=3)

    def test_the_tool_goes_where_inverse_says(self):
        sim, _, arm = self.arm()
        self.move(sim, arm, BENT)
        pose = arm.forward()
        pose[2][3] += 0.1
        self.move(sim, arm, arm.inverse(pose))
        for row, expected in zip(arm.forward(), pose):
            for value, wanted in zip(row, expected):
                self.assertAlmostEqual(value, wanted, places=4)

    def test_commands_of_one_kind_go_together_with_a_step_and_two_kinds_are_refused(self):
        sim, _, arm = self.arm()
        arm.set_velocities(0.1, 1)
        arm.set_velocities([0.3, 0.2], joints=["joint_1", 2])
        self.assert_error(5, lambda: arm.set_positions(0.1, 3), "sim.step() between them")
        sim.step()
        self.assertEqual(arm.get_modes([1, 2, 3])[:2], ["velocity", "velocity"])
        self.assertEqual(arm.get_references([1, 2]), [0.3, 0.2])
        arm.hold()
        sim.step(5)
        self.assertEqual(set(arm.get_modes()), {"position"})

    def test_how_joints_are_driven_is_set_and_read(self):
        _, _, arm = self.arm()
        arm.set_profile(0.5, 2, joints=[1])
        self.assertEqual(arm.get_profile(1), ([0.5], [2.0]))
        arm.set_compliance(50, 2, joints=[1, 2])
        self.assertEqual(arm.get_compliance()[0][:3], [50, 50, math.inf])
        arm.set_compliance(math.inf)
        self.assertEqual(arm.get_compliance(2).k, [math.inf])
        arm.set_gains([10, 20], joints=[3, 4])
        self.assertEqual(arm.get_gains([3, 4]).p, [10, 20])

    def test_wheels_and_an_arm_step_together(self):
        sim, _, _ = self.arm(BOTH)
        robot = sim.robot("m1")
        arm = robot.joints("arm")
        robot.set_velocity(0.2, 0)
        arm.set_velocities(0.1, 1)
        sim.step(50)
        seen = robot.sense()
        self.assertEqual(seen.step, 50)
        self.assertGreater(seen.pose.x, 4.05)
        self.assertGreater(seen.joints["arm"].position[0], 0.04)
        self.assertEqual(seen.joints["arm"], arm.get())

    def test_pushed_readings_of_joints_come(self):
        sim, robot, arm = self.arm()
        robot.subscribe(arm.name)
        sim.step()
        sim.step()
        self.assertEqual(len(robot.next(arm.name, timeout=60).value.position), 7)

    def test_a_program_that_watches_reads_an_arm_and_cannot_drive_it(self):
        daemon = self.start(SCENARIO.format(mode="realtime"))
        arm = self.connect(daemon, watch=True).robot("arm1").joints()
        self.assertEqual(len(arm.get().position), 7)
        self.assert_error(5, lambda: arm.hold(), "only watches")

    def test_a_taken_over_robot_is_lost_with_all_its_actuators(self):
        daemon = self.start(BOTH.format(mode="realtime"))
        mine = self.connect(daemon, name="ana").robot("m1")
        arm = mine.joints()
        self.connect(daemon, name="ana").robot("m1")
        self.assert_error(6, lambda: mine.set_velocity(0.1, 0), "no longer driven by this sim")
        self.assert_error(6, lambda: arm.hold(), "no longer driven by this sim")

    def test_wrong_names_and_counts_say_what_to_write(self):
        _, robot, arm = self.arm()
        self.assert_error(10, lambda: arm.set_positions(1, "elbow"), "joint_1")
        self.assert_error(4, lambda: arm.set_positions(1, 8), "7 joints")
        self.assert_error(3, lambda: arm.set_positions([1, 2]), "each of the 7 joints")
        self.assert_error(4, lambda: arm.set_efforts(math.nan), "finite")
        self.assert_error(4, lambda: arm.set_modes("fast"), "idle")
        self.assert_error(10, lambda: robot.joints("leg"), arm.name)
        self.assert_error(5, lambda: robot.set_velocity(1, 0), "no motors")


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: MIT
"""Muscles, thrusters, drive trains and the channel of a robot, in lockstep and in real time."""
import math
import os
import tempfile
import unittest
from unittest import mock

import limbs
from cases import DaemonTestCase


class Limbs(DaemonTestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        with open(limbs.make(folder.name), encoding="utf-8") as text, mock.patch.dict(os.environ, COOPDYN_PATH=folder.name):
            self.daemon = self.start(text.read())
        self.sim = self.connect(self.daemon)
        self.robot = self.sim.robot("robot1")

    def test_an_activation_goes_with_the_next_step(self):
        muscles = self.robot.muscles()
        muscles.set_activations([0.5, 0.2])
        self.assertEqual(muscles.get().activation, [0, 0])
        self.sim.step()
        self.assertEqual(muscles.get().activation, [0.5, 0.2])

    def test_a_muscle_that_is_named_pulls_and_the_other_keeps_its_activation(self):
        muscles = self.robot.muscles()
        muscles.set_activations(0.1)
        self.sim.step()
        muscles.set_activations(0.8, "biceps")
        self.sim.step(20)
        seen = muscles.get()
        self.assertEqual(seen.activation, [0.8, 0.1])
        self.assertGreater(seen.force[0], seen.force[1])
        self.assertLess(seen.length[0], 0.45)
        self.assertGreater(seen.length[1], 0.55)
        self.assertEqual(muscles.get("triceps").length, seen.length[1:])
        self.assertLess(seen.velocity[0] * seen.velocity[1], 0)
        self.assertTrue(all(0 < factor < 1 for factor in (seen.length_factor[0], seen.velocity_factor[0])))

    def test_muscles_have_names_and_limits(self):
        muscles = self.robot.muscles()
        self.assertEqual(muscles.names, ["biceps", "triceps"])
        self.assertEqual(muscles.get_limits(), ([limbs.MAX_FORCE_N] * 2, [0.5, 0.5], [2, 2]))

    def test_thrusts_go_with_the_next_step(self):
        thrusters = self.robot.thrusters()
        thrusters.set_thrusts([2, 0.1])
        self.sim.step()
        self.assertEqual(thrusters.get().thrust, [2, 0.1])
        thrusters.set_thrusts(-1, "jet")
        self.sim.step()
        self.assertEqual(thrusters.get([2, 1]).thrust, [0.1, -1])
        self.assertEqual(len(thrusters.get().velocity), 2)

    def test_thrusters_have_names_and_limits(self):
        thrusters = self.robot.thrusters()
        self.assertEqual(thrusters.names, ["jet", "spin"])
        self.assertEqual(thrusters.get_limits().max_thrust, [limbs.MAX_THRUST_N, limbs.MAX_TORQUE_NM])

    def test_a_duty_puts_a_joint_into_the_mode_pwm(self):
        joints = self.robot.joints()
        joints.set_pwm(0.5)
        self.sim.step(50)
        self.assertEqual((joints.get_modes(), joints.get_references()), (["pwm"], [0.5]))
        self.assertAlmostEqual(joints.get().velocity[0], 2.5, places=3)  # half of 50 rad/s, over a gear of 10

    def test_a_drive_train_tells_rotor_current_and_energy(self):
        joints = self.robot.joints()
        joints.set_pwm(0.5, "knee")
        self.sim.step()
        train = joints.get_drive_trains()
        self.assertAlmostEqual(train.rotor_position[0], joints.get().position[0], places=6)
        self.assertEqual(len(train.rotor_velocity), 1)
        self.assertGreater(train.current[0], 0)
        self.assertGreater(train.energy[0], 0)

    def test_the_mode_pwm_brakes_until_there_is_a_duty(self):
        joints = self.robot.joints()
        joints.set_modes("pwm")
        self.sim.step()
        self.assertEqual((joints.get_modes(), joints.get_references()), (["pwm"], [0]))

    def test_all_actuators_step_together_in_real_time_too(self):
        self.sim.set_mode("realtime")
        muscles, thrusters, joints = self.robot.muscles(), self.robot.thrusters(), self.robot.joints()
        muscles.set_activations(0.5)
        thrusters.set_thrusts(0.1, "spin")
        joints.set_pwm(0.5)
        self.sim.step(2)
        self.assertEqual(muscles.get().activation, [0.5, 0.5])
        self.assertEqual(thrusters.get("spin").thrust, [0.1])
        self.assertEqual(joints.get_references(), [0.5])

    def test_a_robot_that_lockstep_does_not_wait_for_steps_beside_one_of_several_actuators(self):
        self.sim.robot("robot2")
        for _ in range(10):
            self.sim.step(3, timeout=60)
        self.assertGreaterEqual(self.sim.steps, 30)

    def test_a_sim_that_is_closed_lets_muscles_and_thrusters_go(self):
        self.robot.muscles().set_activations(0.5)
        self.robot.thrusters().set_thrusts(1, "jet")
        self.sim.step()
        self.sim.close()
        again = self.connect(self.daemon)
        robot = again.robot("robot1")
        again.step()
        self.assertEqual(robot.muscles().get().activation, [0, 0])
        self.assertEqual(robot.thrusters().get().thrust, [0, 0])

    def test_a_robot_without_them_says_what_it_has(self):
        robot = self.sim.robot("robot2")
        self.assert_error(5, robot.muscles, "robot2 has no muscles", "motors")
        self.assert_error(5, robot.thrusters, "robot2 has no thrusters", "motors")
        self.assert_error(5, robot.channel, "robot2 has no channel", "motors")

    def test_wrong_names_and_counts_say_what_to_write(self):
        muscles, thrusters = self.robot.muscles(), self.robot.thrusters()
        self.assert_error(10, lambda: muscles.set_activations(1, "calf"), "no muscle 'calf'", "biceps, triceps")
        self.assert_error(4, lambda: muscles.get(3), "2 muscles")
        self.assert_error(3, lambda: thrusters.set_thrusts([1, 2, 3]), "each of the 2 thrusters")
        self.assert_error(4, lambda: thrusters.set_thrusts(math.nan), "finite")
        self.assert_error(2, lambda: thrusters.set_thrusts(), "t.set_thrusts(")

    def test_a_joint_without_a_drive_train_takes_no_duty(self):
        arm = self.connect(self.start("[SIMULATION]\nmode lockstep\n[ROBOT_1]\ntype lwa\nname arm1\nposition 0 0\n"))
        joints = arm.robot("arm1").joints()
        self.assertTrue(math.isnan(joints.get_drive_trains(1).current[0]))
        joints.set_pwm(0.5)
        self.assert_error(5, arm.step, "has no drive train")

    # --- the channel

    def test_a_channel_has_motors_and_values_with_names_and_ranges(self):
        channel = self.robot.channel()
        self.assertEqual([motor.name for motor in channel.motors], ["knee_motor", "pull"])
        self.assertEqual([value.name for value in channel.values], ["knee_speed", "place", "place"])
        self.assertEqual(channel.motors[0], ("knee_motor", -4, 4, -1, 1, False))
        self.assertEqual((channel.values[1].external_max, channel.values[1].auxiliary), (math.inf, True))
        self.assertEqual(channel.steps, limbs.STEPS)

    def test_what_a_channel_sets_goes_with_the_next_step_and_stays(self):
        channel = self.robot.channel()
        channel.set([0.5, 0.3])
        self.sim.step(40)
        self.assertEqual(self.sim.steps, 40)
        self.assertAlmostEqual(channel.get()[0], 0.5, places=3)
        self.assertEqual(self.robot.muscles().get("biceps").activation, [0.3])

    def test_a_motor_that_is_named_is_set_and_the_others_stay(self):
        channel = self.robot.channel()
        channel.set(0.5)
        channel.set(0.2, "knee_motor")
        self.sim.step(40)
        self.assertAlmostEqual(channel.get("knee_speed")[0], 0.2, places=3)
        self.assertEqual(self.robot.muscles().get("biceps").activation, [0.5])

    def test_values_are_read_by_name_and_number(self):
        channel = self.robot.channel()
        self.sim.step()
        values = channel.get()
        self.assertEqual(channel.get("place"), values[1:])
        self.assertEqual(channel.get([3, 1]), [values[2], values[0]])
        self.assertFalse(channel.aborted())

    def test_a_channel_drives_in_real_time(self):
        self.sim.set_mode("realtime")
        channel = self.robot.channel()
        channel.set([-0.5, 0])
        for _ in range(1000):
            self.sim.step()
            if abs(channel.get("knee_speed")[0] + 0.5) < 1e-3:
                return
        self.fail("it does not turn")

    def test_a_robot_that_its_channel_drives_takes_nothing_else(self):
        muscles = self.robot.muscles()
        self.robot.channel()
        self.assert_error(5, lambda: muscles.set_activations(1), "driven through its channel")
        self.sim.step()
        self.assertEqual(self.robot.sense().step, 1)

    def test_a_robot_that_was_freed_from_its_channel_is_taken_again_with_all(self):
        channel = self.robot.channel()
        channel.set(0)
        self.sim.step()
        self.connect(self.daemon).release_robot("robot1")
        self.assert_error(6, lambda: (channel.get(), self.sim.step()), "no longer driven by this sim")
        muscles = self.sim.robot("robot1").muscles()
        muscles.set_activations(0.5)
        self.sim.step()
        self.assertEqual(muscles.get().activation, [0.5, 0.5])

    def test_the_first_exchange_sets_all_motors(self):
        channel = self.robot.channel()
        self.assert_error(5, lambda: channel.set(0.2, "pull"), "all 2 motors first")
        self.assert_error(10, lambda: channel.set(0.2, "push"), "knee_motor, pull")


if __name__ == "__main__":
    unittest.main()

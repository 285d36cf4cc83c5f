# SPDX-License-Identifier: MIT
"""Forward and inverse kinematics of serial chains made by hand. No daemon."""
import math
import random
import unittest

import harness  # noqa: F401  (finds coopdyn.py)
import coopdyn

UNIT = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


def at(x, y, z):
    return [[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]]


def planar(a=0.4, b=0.3, **limits):
    """Two hinges about z, links along x."""
    return coopdyn.Chain([0, 0], [(0, 0, 0), (a, 0, 0)], [(0, 0, 1), (0, 0, 1)], at(a + b, 0, 0), **limits)


def seven_axes():
    """Shoulder, elbow and wrist of a 7-axis arm that stands upright: axes z y z y z y z."""
    z, y = (0, 0, 1), (0, 1, 0)
    heights = [0.1, 0.3, 0.45, 0.63, 0.8, 0.95, 1.02]
    limits = [3.1, 2.0, 3.1, 2.0, 3.1, 2.0, 6.2]
    return coopdyn.Chain([0] * 7, [(0, 0, h) for h in heights], [z, y, z, y, z, y, z], at(0, 0, 1.1),
                         lower=[-x for x in limits], upper=limits)


def largest_difference(A, B):
    return max(abs(a - b) for row_a, row_b in zip(A, B) for a, b in zip(row_a, row_b))


class ForwardTest(unittest.TestCase):
    def test_two_hinges_in_a_plane_follow_the_closed_form(self):
        chain = planar()
        for q1, q2 in ((0, 0), (0.3, 0.5), (-1.2, 2.0), (3.0, -0.4)):
            s, c = math.sin(q1 + q2), math.cos(q1 + q2)
            x, y = 0.4 * math.cos(q1) + 0.3 * c, 0.4 * math.sin(q1) + 0.3 * s
            expected = [[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, 0], [0, 0, 0, 1]]
            self.assertLess(largest_difference(chain.forward([q1, q2]), expected), 1e-15)

    def test_a_slider_after_a_hinge_slides_along_the_turned_axis(self):
        chain = coopdyn.Chain([0, 1], [(0, 0, 0), (0, 0, 0)], [(0, 0, 2), (1, 0, 0)], at(0.1, 0, 0.5))
        pose = chain.forward([math.pi / 2, 0.2])
        self.assertLess(largest_difference(pose, [[0, -1, 0, 0], [1, 0, 0, 0.3], [0, 0, 1, 0.5], [0, 0, 0, 1]]), 1e-15)

    def test_a_slider_before_a_hinge_carries_its_axis(self):
        chain = coopdyn.Chain([1, 0], [(0, 0, 0), (0, 0, 0)], [(0, 0, 1), (0, 1, 0)], at(0.5, 0, 0))
        pose = chain.forward([0.3, math.pi / 2])
        self.assertLess(largest_difference(pose, [[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, -0.2], [0, 0, 0, 1]]), 1e-15)


class InverseTest(unittest.TestCase):
    def test_random_postures_of_seven_axes_are_found_again(self):
        chain, dice = seven_axes(), random.Random(1)
        for _ in range(40):
            pose = chain.forward([dice.uniform(low, high) for low, high in zip(chain.lower, chain.upper)])
            q = chain.inverse(pose, [0.1] * 7)
            self.assertLess(largest_difference(chain.forward(q), pose), 1e-6)
            self.assertTrue(all(low <= x <= high for low, x, high in zip(chain.lower, q, chain.upper)), q)

    def test_the_posture_nearest_to_the_start_is_kept(self):
        chain = planar()
        for elbow in (0.8, -0.8):
            q = chain.inverse(chain.forward([0.3, elbow]), [0.25, elbow * 0.9])
            self.assertAlmostEqual(q[0], 0.3)
            self.assertAlmostEqual(q[1], elbow)

    def test_limits_decide_between_two_postures(self):
        chain = planar(lower=[-3, 0.1], upper=[3, 3])
        pose = chain.forward([0.3, 0.8])
        q = chain.inverse(pose, [0.9, 0.1])
        self.assertLess(largest_difference(chain.forward(q), pose), 1e-6)
        self.assertAlmostEqual(q[1], 0.8)

    def test_a_position_alone_leaves_the_direction_free(self):
        q = planar().inverse([0.2, 0.5, 0.0], [0.1, 0.1])
        pose = planar().forward(q)
        self.assertAlmostEqual(pose[0][3], 0.2)
        self.assertAlmostEqual(pose[1][3], 0.5)

    def test_a_straight_arm_at_the_end_of_its_reach_is_found(self):
        chain = planar()
        q = chain.inverse([0.7 - 1e-9, 0.0, 0.0], [0.4, -0.7])
        self.assertLess(abs(chain.forward(q)[0][3] - 0.7), 1e-6)

    def test_half_a_turn_of_the_tool_is_found(self):
        chain = seven_axes()
        pose = chain.forward([0.3, 0.6, 0.2, 0.9, 0.1, -0.7, 0.0])
        turned = chain.forward([0.3, 0.6, 0.2, 0.9, 0.1, -0.7, math.pi])
        q = chain.inverse(turned, chain.inverse(pose))
        self.assertLess(largest_difference(chain.forward(q), turned), 1e-6)

    def test_what_is_out_of_reach_is_said_with_the_distance(self):
        with self.assertRaises(coopdyn.Error) as caught:
            planar().inverse([1.0, 0.0, 0.0])
        self.assertEqual(caught.exception.code, 4)
        self.assertIn("the nearest is 0.3 m off", caught.exception.text)

    def test_a_pose_that_limits_forbid_is_refused(self):
        with self.assertRaises(coopdyn.Error):
            planar(lower=[0, 0], upper=[0.5, 0.5]).inverse([0.0, -0.5, 0.0])

    def test_the_same_call_gives_the_same_posture(self):
        chain = seven_axes()
        pose = chain.forward([1, 1, 1, 1, 1, 1, 1])
        self.assertEqual(chain.inverse(pose), chain.inverse(pose))


class ArgumentsTest(unittest.TestCase):
    def expect(self, code, what, call, *arguments):
        with self.assertRaises(coopdyn.Error) as caught:
            call(*arguments)
        self.assertEqual(caught.exception.code, code)
        self.assertIn(what, caught.exception.text)

    def test_wrong_values_say_what_to_write(self):
        chain = planar()
        self.expect(3, "3 values, the chain 2 joints", chain.forward, [1, 2, 3])
        self.expect(4, "must be finite", chain.forward, [1, math.nan])
        self.expect(3, "4 x 4 matrix", chain.inverse, [[1, 0], [0, 1]])
        self.expect(3, "not 2 numbers", chain.inverse, [1, 2])
        self.expect(3, "4 x 4 matrix or a position", chain.inverse, 5)
        self.expect(4, "rotation", chain.inverse, [[2, 0, 0, 0]] + UNIT[1:])
        self.expect(3, "2 joints has", coopdyn.Chain, [0, 0], [(0, 0, 0)], [(0, 0, 1)], UNIT)
        self.expect(4, "direction", coopdyn.Chain, [0], [(0, 0, 0)], [(0, 0, 0)], UNIT)


if __name__ == "__main__":
    unittest.main()

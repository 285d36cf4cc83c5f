# SPDX-License-Identifier: MIT
"""Follows the wall on the right using a lidar: python3 wall.py [robot1 [SECONDS]]

Scenario `wall`. Two rays see the wall: b to the right, and a, turned ahead by the angle theta. They yield the robot's heading
relative to the wall, its distance from the wall (or from the nearest thing on the right), and this distance after l more metres,

    alpha = atan2(a cos(theta) - b, a sin(theta)),   d = b cos(alpha),   d_ahead = d + l sin(alpha).

The turn rate controls d_ahead to the desired distance; near things ahead make the robot slow down and turn left. All three languages
use the same algorithm and numbers.
"""
import math
import sys

import coopdyn

WALL_DISTANCE = 0.5  # [m] from the lidar
SIDE = 1.5707963  # [rad] bearing of b, to the right
AHEAD_BY = 0.7  # theta [rad]
LOOK_AHEAD = 0.5  # l [m]
GAIN = 4.0  # [rad/s/m]
SPEED = 0.2  # [m/s]
MAX_TURN = 1.0  # [rad/s]
MAX_SINE = 0.25  # of alpha
RIGHT = 1.05  # [rad] to either side of b: the search for the wall
FREE = 0.7  # [m] the robot turns if something ahead is nearer
CONE = 0.35  # [rad] to either side of ahead
SEEN = 2.0  # [m] longer ranges are clamped to this


def ray(scan, bearing):
    """The range [m] of the ray nearest to a bearing [rad], in the middle row."""
    off = [abs(math.remainder(azimuth - bearing, 2 * math.pi)) for azimuth in scan.azimuth]
    return min(SEEN, scan.ranges[len(scan.elevation) // 2][off.index(min(off))])


def nearest(scan, bearing, cone):
    """The shortest range [m] of the rays within `cone` of a bearing [rad], in the middle row."""
    row = scan.ranges[len(scan.elevation) // 2]
    return min([SEEN] + [r for azimuth, r in zip(scan.azimuth, row) if abs(math.remainder(azimuth - bearing, 2 * math.pi)) <= cone])


def command(scan):
    """Speed [m/s], turn rate [rad/s], and the present distance of the wall [m]."""
    a, b = ray(scan, AHEAD_BY - SIDE), ray(scan, -SIDE)
    alpha = math.atan2(a * math.cos(AHEAD_BY) - b, a * math.sin(AHEAD_BY))
    distance, free = min(b * math.cos(alpha), nearest(scan, -SIDE, RIGHT)), nearest(scan, 0, CONE)
    turn = GAIN * (WALL_DISTANCE - (distance + LOOK_AHEAD * max(-MAX_SINE, min(MAX_SINE, math.sin(alpha)))))
    if free < FREE:
        return SPEED * max(0.0, free / FREE - 0.4), MAX_TURN, distance
    return SPEED, max(-MAX_TURN, min(MAX_TURN, turn)), distance


def main(name="robot1", duration="60"):
    with coopdyn.connect() as sim:
        r = sim.robot(name)
        start = sim.time
        s = r.sense()
        near, steps, least = 0, 0, math.inf
        while s.time - start < float(duration):
            speed, turn, distance = command(s.scan)
            r.set_velocity(speed, turn)
            steps += 1
            near += abs(distance - WALL_DISTANCE) < 0.1
            least = min(least, min(r for row in s.scan.ranges for r in row))
            sim.step()
            s = r.sense()
        print(f"{name} kept the wall within 0.1 m of {WALL_DISTANCE:g} m for {100 * near / steps:.0f} % of the time, and {least:.3f} m from "
              "everything")
        return 0


if __name__ == "__main__":
    try:
        sys.exit(main(*sys.argv[1:]))
    except coopdyn.Error as error:
        sys.exit(str(error))

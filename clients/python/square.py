# SPDX-License-Identifier: MIT
"""Draws a square in the air with a robot's arm: python3 square.py [ROBOT]. Runs in lockstep and in real time."""
import math
import sys

import coopdyn

SIDE_M = 0.2
SIDE_S = 2.0  # for each side


def smooth(s):
    """From 0 to 1 with minimum jerk."""
    return s * s * s * (10 - 15 * s + 6 * s * s)


def move(sim, arm, q):
    arm.set_positions(q)
    while True:
        sim.step()
        if arm.arrived():
            return


def distance(x, y, z):
    """A point on the outline of the square in the plane x = 0, centred at 0."""
    y, z = abs(y) - SIDE_M / 2, abs(z) - SIDE_M / 2
    outside = math.hypot(max(y, 0), max(z, 0))
    return math.hypot(x, outside if outside > 0 else max(y, z))


def main(name="robot1"):
    with coopdyn.connect() as sim:
        robot = sim.robot(name)
        arm = robot.joints()
        # Bend the arm forward, so that the tool can move in all directions: 0.8 rad about each axis that points left.
        move(sim, arm, [0.8 * round(y) for _, y, _ in arm.get_chain().axes])
        pose = arm.forward()
        x, y, z = (row[3] for row in pose[:3])  # the centre of the square

        # The path of the joints: one posture per step, each found near the previous one.
        dt, half = sim.dt, SIDE_M / 2
        steps = round(SIDE_S / dt)
        corners = [(y - half, z - half), (y + half, z - half), (y + half, z + half), (y - half, z + half)]
        way, q = [], arm.get().position
        for k in range(4 * steps + 1):
            side, s = divmod(k / steps, 1)
            a, b = corners[int(side) % 4], corners[(int(side) + 1) % 4]
            pose[1][3], pose[2][3] = (c + smooth(s) * (d - c) for c, d in zip(a, b))
            q = arm.inverse(pose, q)
            way.append(q)

        move(sim, arm, way[0])
        off, began = 0.0, sim.time
        while True:
            k = round((sim.time - began) / dt) + 1
            if k >= len(way):
                break
            arm.set_positions_direct(way[k])
            sim.step()
            reached = arm.forward(robot.sense().joints[arm.name].position)
            off = max(off, distance(reached[0][3] - x, reached[1][3] - y, reached[2][3] - z))
        print(f"a square of {SIDE_M} m in {sim.time - began:.2f} s, at most {1000 * off:.3f} mm off")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except coopdyn.Error as error:
        sys.exit(str(error))

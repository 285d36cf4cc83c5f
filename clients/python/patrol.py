# SPDX-License-Identifier: MIT
"""Drives a robot to the red target, back to its start, and so on: the demo of ./start.

python3 patrol.py [--robot robot1] [--minutes 2]      Ends when the time is over or another client frees the robot.
"""
import argparse
import math
import time
from types import SimpleNamespace

import coopdyn
from attractor import REACHED, Attractor


def bearing_of(pose, goal):
    """Distance and bearing of a point (x, y), as for a target there."""
    dx, dy = goal[0] - pose.x, goal[1] - pose.y
    angle = math.atan2(dy, dx) - pose.heading
    return SimpleNamespace(distance=math.hypot(dx, dy), bearing=math.atan2(math.sin(angle), math.cos(angle)))


def patrol(sim, robot, seconds):
    controller = Attractor(robot.get_geometry())
    start = robot.get_pose()
    home, outward, dt = (start.x, start.y), True, sim.dt
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        s = robot.sense("red")
        goal = s.target if outward else bearing_of(s.pose, home)
        if goal.distance < REACHED:
            outward = not outward
        robot.set_velocity(*controller.command(goal, s.distances, dt))
        sim.step()


def main():
    parser = argparse.ArgumentParser(description="Drives a robot to the red target and back.")
    parser.add_argument("--robot", default="robot1")
    parser.add_argument("--minutes", type=float, default=2)
    options = parser.parse_args()
    try:
        with coopdyn.connect(name="patrol") as sim:
            patrol(sim, sim.robot(options.robot), 60 * options.minutes)
    except (coopdyn.Error, KeyboardInterrupt):
        pass  # the robot was freed, or the daemon has ended


if __name__ == "__main__":
    main()

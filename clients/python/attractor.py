# SPDX-License-Identifier: MIT
"""Drives robots to the red target past obstacles: python3 attractor.py [robot1 robot2 ...]

The heading is a dynamical system (Schoener, Dose, Engels; Bicho): the target's bearing attracts it, and every distance
sensor that sees something near repels it,

    dphi/dt = -l_tar sin(phi - psi_tar) + sum_i l_i (phi - psi_i) exp(-(phi - psi_i)^2 / (2 s_i^2)),
    l_i = b1 exp(-d_i / b2),   s_i = atan(tan(opening_i / 2) + R / (R + d_i)),

and the speed relaxes to the value that the target or the obstacles allow, weighted by the repulsion's potential at the
present heading. Angles are relative to the robot, so phi = 0. All three languages use the same algorithm and numbers.
"""
import math
import sys

import coopdyn

ROBOT_RADIUS = 0.18  # [m]
TARGET_STRENGTH = 1.6  # [rad/s]
OBSTACLE_STRENGTH = 10.0  # b1 [1/s]
OBSTACLE_DECAY = 0.3  # b2 [m]
BIAS = 0.02  # [rad/s] instead of noise: turns off a heading exactly between left and right, repeatably
MAX_SPEED = 0.5  # [m/s]
MAX_TURN = 1.8  # [rad/s]
TIME_TO_TARGET = 1.5  # [s] limits the speed by the target's distance
TIME_TO_CONTACT = 1.2  # [s] limits the speed by the distance of obstacles ahead
AHEAD = math.radians(50)  # sensors within this bearing are ahead
RELAXATION = 8.0  # [1/s] of the speed
REACHED = 0.4  # [m] from the axle's midpoint to the target
REACHED_BY_MANY = 0.9  # [m] if several robots share it
TIME_LIMIT = 180.0  # [s] simulated


class Attractor:
    """The state of one robot's controller: its speed."""

    def __init__(self, geometry):
        self.bearings = geometry.bearing
        self.openings = geometry.opening
        self.speed = 0.0

    def command(self, target, distances, dt):
        """Speed [m/s] and turn rate [rad/s] for the next dt [s]."""
        turn = TARGET_STRENGTH * math.sin(target.bearing) + BIAS
        potential, free = 0.0, math.inf
        for d, psi, opening in zip(distances, self.bearings, self.openings):
            if d == math.inf:
                continue
            strength = OBSTACLE_STRENGTH * math.exp(-d / OBSTACLE_DECAY)
            width = math.atan(math.tan(opening / 2) + ROBOT_RADIUS / (ROBOT_RADIUS + d))
            gauss = math.exp(-(psi**2) / (2 * width**2))
            turn -= strength * psi * gauss
            potential += strength * width**2 * (gauss - math.exp(-0.5))
            if abs(psi) <= AHEAD:
                free = min(free, d)
        turn = max(-MAX_TURN, min(MAX_TURN, turn))
        near = math.atan(8 * potential) / math.pi  # -1/2: nothing near ahead, 1/2: much
        by_target = min(MAX_SPEED, target.distance / TIME_TO_TARGET) * max(0.1, math.cos(target.bearing / 2))
        by_obstacles = min(MAX_SPEED, free / TIME_TO_CONTACT)
        wanted = (0.5 - near) * by_target + (0.5 + near) * min(by_target, by_obstacles)
        self.speed = wanted + (self.speed - wanted) * math.exp(-RELAXATION * dt)
        return self.speed, turn


def main(names):
    reached_at = REACHED if len(names) == 1 else REACHED_BY_MANY
    with coopdyn.connect() as sim:
        robots = [sim.robot(name) for name in names]
        controllers = [Attractor(r.get_geometry()) for r in robots]
        dt = sim.dt
        start = sim.time
        driving = set(names)
        while driving and sim.time - start < TIME_LIMIT:
            for r, controller in zip(robots, controllers):
                if r.name not in driving:
                    continue
                s = r.sense("red")
                if s.target.distance < reached_at:
                    r.stop()
                    driving.remove(r.name)
                    print(f"{r.name} reached the target: {s.pose.x:.2f} {s.pose.y:.2f} at t = {s.time:.2f} s")
                else:
                    r.set_velocity(*controller.command(s.target, s.distances, dt))
            sim.step()
        for name in sorted(driving):
            print(f"{name} did not reach the target in {TIME_LIMIT:g} s")
        return 1 if driving else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:] or ["robot1"]))

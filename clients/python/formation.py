# SPDX-License-Identifier: MIT
"""Robots keep a formation round obstacles on the way to the red target: python3 formation.py [robot1 robot2 ...]

The first robot leads. Five keep an inverted V, three a triangle (along and across below); near obstacles they break the
formation and restore it behind them. Attractor dynamics (Monteiro, Bicho): a follower turns towards its place, which moves
with the leader, and away from obstacles. docs/teams.md has the equations. All languages use the same algorithm and numbers.
"""
import math
import sys

import coopdyn

ROBOT_RADIUS = 0.18  # [m]
TARGET_STRENGTH = 1.2  # [rad/s]
PLACE_STRENGTH = 2.5  # [rad/s] of a follower towards its place
OBSTACLE_STRENGTH = 10.0  # [1/s]
OBSTACLE_DECAY = 0.2  # [m]
BIAS = 0.02  # [rad/s] instead of noise
LEADER_SPEED = 0.3  # [m/s]
FOLLOWER_SPEED = 0.6  # [m/s]
MAX_TURN = 1.8  # [rad/s]
TIME_TO_TARGET = 1.5  # [s]
TIME_TO_CONTACT = 1.2  # [s]
RELAXATION = 8.0  # [1/s] of the speed
AHEAD = 0.873  # [rad]
REACHED = 0.4  # [m] from the leader to the target
PULL = 0.8  # [1/s] speed per distance to the place
NEAR = 0.04  # [m] nearer to its place a robot is not pulled
CALM = 0.05  # [m/s] a slower wanted velocity turns the robot less
AWAY = 0.25  # least share of the wanted speed while an obstacle turns the robot away
PATIENCE = 0.3  # [m] the leader slows down when a robot is farther from its place
SLOWEST = 0.2  # share of its speed, at twice that distance
V_ALONG, V_ACROSS = 1.0, 1.0  # [m] from row to row, and from the middle to the first row, of the inverted V
TRIANGLE_ALONG, TRIANGLE_ACROSS = 1.04, 0.6  # [m] of three robots
CLOSED = 0.1  # [m] largest distance of a robot from its place at the end
TIME_LIMIT = 240.0  # [s] simulated


def clamp(value, low, high):
    return max(low, min(high, value))


def place_of(number, count):
    """The place of robot `number` in the leader's frame."""
    a, b = (TRIANGLE_ALONG, TRIANGLE_ACROSS) if count == 3 else (V_ALONG, V_ACROSS)
    row = (number + 1) // 2
    return -a * row, b * row if number % 2 == 1 else -b * row


class Formed:
    """The controller of one robot. Its state is its speed."""

    def __init__(self, geometry):
        self.geometry = geometry
        self.speed = 0.0

    def lead(self, target, worst, distances, dt):
        """Speed [m/s] and turn rate [rad/s] to the target; `worst`: the greatest distance of a follower from its place [m]."""
        if target.distance < REACHED:
            self.speed = 0.0
            return 0.0, 0.0
        away, potential, free = self.obstacles(distances)
        turn = TARGET_STRENGTH * math.sin(target.bearing) + BIAS + away
        patience = clamp(2 - worst / PATIENCE, SLOWEST, 1.0)
        by_target = min(patience * LEADER_SPEED, target.distance / TIME_TO_TARGET) * max(0.1, math.cos(target.bearing / 2))
        self.relax(by_target, potential, free, dt)
        return self.speed, clamp(turn, -MAX_TURN, MAX_TURN)

    def follow(self, off, carried, distances, dt):
        """Speed and turn rate to the place, which is at `off` and moves by `carried`, both in this robot's frame."""
        way = math.hypot(*off)
        pull = PULL * (1 - NEAR / way) if way > NEAR else 0.0
        x, y = carried[0] + pull * off[0], carried[1] + pull * off[1]
        wish, bearing = math.hypot(x, y), math.atan2(y, x)
        away, potential, free = self.obstacles(distances)
        turn = min(1.0, wish / CALM) * (PLACE_STRENGTH * math.sin(bearing) + away)
        self.relax(min(wish * max(AWAY, math.cos(bearing)), FOLLOWER_SPEED), potential, free, dt)
        return self.speed, clamp(turn, -MAX_TURN, MAX_TURN)

    def obstacles(self, distances):
        """Turn rate, potential and free distance ahead."""
        turn, potential, free = 0.0, 0.0, math.inf
        for d, psi, opening in zip(distances, self.geometry.bearing, self.geometry.opening):
            if d == math.inf:
                continue
            weight = OBSTACLE_STRENGTH * math.exp(-d / OBSTACLE_DECAY)
            width = math.atan(math.tan(opening / 2) + ROBOT_RADIUS / (ROBOT_RADIUS + d))
            gauss = math.exp(-(psi**2) / (2 * width**2))
            turn -= weight * psi * gauss
            potential += weight * width**2 * (gauss - math.exp(-0.5))
            if abs(psi) <= AHEAD:
                free = min(free, d)
        return turn, potential, free

    def relax(self, wanted, potential, free, dt):
        near = math.atan(8 * potential) / math.pi  # -1/2: nothing near ahead, 1/2: much
        wanted = (0.5 - near) * wanted + (0.5 + near) * min(wanted, free / TIME_TO_CONTACT)
        self.speed = wanted + (self.speed - wanted) * math.exp(-RELAXATION * dt)


def turned(x, y, angle):
    return math.cos(angle) * x - math.sin(angle) * y, math.sin(angle) * x + math.cos(angle) * y


def way_to_place(place, leader, own):
    """The vector from a robot to its place, in the robot's frame; `leader`, `own`: poses."""
    x, y = turned(*place, leader.heading)
    return turned(leader.x + x - own.x, leader.y + y - own.y, -own.heading)


def main(names):
    with coopdyn.connect() as sim:
        names = names or sim.robots()
        robots = [sim.robot(name) for name in names]
        controllers = [Formed(r.get_geometry()) for r in robots]
        places = [place_of(number, len(names)) for number in range(len(names))]
        dt = sim.dt
        start = sim.time
        told = (0.0, 0.0)  # the leader's command
        while sim.time - start < TIME_LIMIT:
            seen = [r.sense("red") for r in robots]
            leader = seen[0].pose
            ways = [way_to_place(place, leader, s.pose) for place, s in zip(places, seen)]
            worst = max(math.hypot(*way) for way in ways)
            if seen[0].target.distance < REACHED and worst < CLOSED:
                print(f"the formation reached the target, {100 * worst:.1f} cm off, at t = {seen[0].time:.2f} s")
                return 0
            for number, (robot, controller, s) in enumerate(zip(robots, controllers, seen)):
                if number == 0:
                    v, w = controller.lead(s.target, worst, s.distances, dt)
                else:
                    x, y = places[number]
                    carried = turned(told[0] - told[1] * y, told[1] * x, leader.heading - s.pose.heading)
                    v, w = controller.follow(ways[number], carried, s.distances, dt)
                robot.set_velocity(v, w)
                if number == 0:
                    told = (v, w)
            sim.step()
        print(f"the formation did not reach the target in {TIME_LIMIT:g} s")
        return 1


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except coopdyn.Error as error:
        sys.exit(str(error))

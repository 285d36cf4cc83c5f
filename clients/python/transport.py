# SPDX-License-Identifier: MIT
"""Teams of two robots carry bars to the targets, past obstacles: python3 transport.py [team1 team2 ...]

The first team goes to the scenario's first target, the second to the second. Leader and helper follow attractor dynamics
(Bicho, Louro, Soares, Erlhagen): the leader turns to the target and away from obstacles, as fast as its load follows. The
helper knows no target: its heading turns along the bar, and its speed brings the load back to the middle of its support.
docs/teams.md has the equations. All languages use the same algorithm and numbers.
"""
import math
import sys

import coopdyn

ROBOT_RADIUS = 0.18  # [m]
TEAM_DISTANCE = 1.2  # [m] from leader to helper
TARGET_STRENGTH = 0.9  # [rad/s]
BAR_STRENGTH = 2.5  # [rad/s] of the helper's turn along the bar
LEADER_OBSTACLE = 6.0  # [1/s]
LEADER_DECAY = 0.45  # [m] the leader keeps room for the bar behind it
HELPER_OBSTACLE = 4.0  # [1/s]
HELPER_DECAY = 0.2  # [m]
BIAS = 0.02  # [rad/s] instead of noise
LEADER_SPEED = 0.3  # [m/s]
HELPER_SPEED = 0.5  # [m/s]
LEADER_TURN = 0.8  # [rad/s]
HELPER_TURN = 1.8  # [rad/s]
TIME_TO_TARGET = 1.5  # [s]
TIME_TO_CONTACT = 1.6  # [s]
RELAXATION = 2.0  # [1/s] of the leader's speed
AHEAD = 0.873  # [rad]
REACHED = 0.4  # [m] from the leader to the target
FOLD = 1.3  # [rad] beyond, a robot turns back towards the bar
FOLD_STRENGTH = 4.0  # [1/s]
FOLLOW = 12.0  # [1/s] speed per displacement of the load along the bar
FOLLOW_INTEGRAL = 8.0  # [1/s²]
ACROSS = 5.0  # [rad/s per m] of the load across the bar
SLACK = 0.055  # [m] lag of the load at which the leader stops
EASE = 0.03  # [m] the leader slows down from a lag of SLACK - EASE on
MATE_WIDTH = 0.35  # [rad] ranges this close to the mate's bearing are the mate
MATE_NEAR = 0.25  # [m] unless they are nearer than the mate by more than this
SETTLE = 2.0  # [s] for the helpers after the leaders have arrived
TIME_LIMIT = 180.0  # [s] simulated


def clamp(value, low, high):
    return max(low, min(high, value))


def along(load):
    """The load's displacement along the bar."""
    return load.x * math.cos(load.angle) + load.y * math.sin(load.angle)


def across(load):
    return load.y * math.cos(load.angle) - load.x * math.sin(load.angle)


def unfold(angle):
    """Turn rate back towards the bar if the heading deviates too far from it."""
    return 0.0 if abs(angle) <= FOLD else FOLD_STRENGTH * (angle - math.copysign(FOLD, angle))


def obstacles(geometry, distances, strength, decay, mate):
    """Turn rate, potential and free distance ahead; ranges near the bearing `mate` are the other robot of the team."""
    turn, potential, free = 0.0, 0.0, math.inf
    for d, psi, opening in zip(distances, geometry.bearing, geometry.opening):
        if d == math.inf:
            continue
        off = math.remainder(psi - mate, 2 * math.pi)
        if abs(off) < MATE_WIDTH and d > TEAM_DISTANCE - 2 * ROBOT_RADIUS - MATE_NEAR:
            continue
        weight = strength * math.exp(-d / decay)
        width = math.atan(math.tan(opening / 2) + ROBOT_RADIUS / (ROBOT_RADIUS + d))
        gauss = math.exp(-(psi**2) / (2 * width**2))
        turn -= weight * psi * gauss
        potential += weight * width**2 * (gauss - math.exp(-0.5))
        if abs(psi) <= AHEAD:
            free = min(free, d)
    return turn, potential, free


class Leader:
    """Drives to the target past obstacles, as fast as the load follows. Its state is the speed."""

    def __init__(self, geometry):
        self.geometry = geometry
        self.speed = 0.0

    def command(self, target, distances, load, dt):
        """Speed [m/s] and turn rate [rad/s] for the next dt [s]."""
        if target.distance < REACHED:
            self.speed = 0.0
            return 0.0, 0.0
        away, potential, free = obstacles(self.geometry, distances, LEADER_OBSTACLE, LEADER_DECAY, load.angle + math.pi)
        turn = clamp(TARGET_STRENGTH * math.sin(target.bearing) + BIAS + away, -LEADER_TURN, LEADER_TURN)
        near = math.atan(8 * potential) / math.pi  # -1/2: nothing near ahead, 1/2: much
        by_target = min(LEADER_SPEED, target.distance / TIME_TO_TARGET) * max(0.1, math.cos(target.bearing / 2))
        by_obstacles = min(LEADER_SPEED, free / TIME_TO_CONTACT)
        by_load = clamp((SLACK + along(load)) / EASE, 0.0, 1.0)
        wanted = by_load * ((0.5 - near) * by_target + (0.5 + near) * min(by_target, by_obstacles))
        self.speed = wanted + (self.speed - wanted) * math.exp(-RELAXATION * dt)
        return self.speed * by_load, turn + unfold(load.angle)


class Helper:
    """Follows the load. Its state is the leader's estimated speed along the bar."""

    def __init__(self, geometry):
        self.geometry = geometry
        self.speed = 0.0

    def command(self, distances, load, dt):
        """Speed [m/s] and turn rate [rad/s] for the next dt [s]."""
        away, _, _ = obstacles(self.geometry, distances, HELPER_OBSTACLE, HELPER_DECAY, load.angle)
        turn = BAR_STRENGTH * math.sin(load.angle) + ACROSS * across(load) + away + unfold(load.angle)
        self.speed = clamp(self.speed + FOLLOW_INTEGRAL * along(load) * dt, -HELPER_SPEED, HELPER_SPEED)
        wanted = (self.speed + FOLLOW * along(load)) / max(0.5, math.cos(load.angle))
        return clamp(wanted, -HELPER_SPEED, HELPER_SPEED), clamp(turn, -HELPER_TURN, HELPER_TURN)


class Team:
    """Leader and helper of a team, and the number of their target."""

    def __init__(self, sim, name, number):
        self.name, self.number = name, number
        self.front, self.back = sim.robot(f"{name}_leader"), sim.robot(f"{name}_helper")
        self.leader, self.helper = Leader(self.front.get_geometry()), Helper(self.back.get_geometry())
        self.arrived = None  # time of arrival

    def drive(self, dt):
        s = self.front.sense()
        target = s.targets[self.number % len(s.targets)]
        self.front.set_velocity(*self.leader.command(target, s.distances, s.support, dt))
        if target.distance < REACHED and self.arrived is None:
            self.arrived = s.time
            print(f"{self.name} arrived: {s.pose.x:.2f} {s.pose.y:.2f} at t = {s.time:.2f} s")
        s = self.back.sense()
        self.back.set_velocity(*self.helper.command(s.distances, s.support, dt))


def main(names):
    with coopdyn.connect() as sim:
        names = names or [name[: -len("_leader")] for name in sim.robots() if name.endswith("_leader")]
        teams = [Team(sim, name, number) for number, name in enumerate(names)]
        if not teams:
            print("there is no team here; run the daemon with: coopdyn serve transport")
            return 1
        dt = sim.dt
        start = sim.time
        while sim.time - start < TIME_LIMIT:
            if all(team.arrived is not None and sim.time - team.arrived > SETTLE for team in teams):
                break
            for team in teams:
                team.drive(dt)
            sim.step()
        late = [team.name for team in teams if team.arrived is None]
        for name in late:
            print(f"{name} did not arrive in {TIME_LIMIT:g} s")
        return 1 if late else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except coopdyn.Error as error:
        sys.exit(str(error))

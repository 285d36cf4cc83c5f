# SPDX-License-Identifier: MIT
"""A swarm that spreads: every robot drives ahead and turns away from near things. Runs in real time and in lockstep.

python3 swarm.py [swarm1]          names of swarms or robots; default: all free robots. Try it with coopdyn serve swarm100
"""
import math
import sys

import coopdyn

SPEED = 0.1  # m/s
GAIN = 2.0  # 1/s


def away_from(distances, geometry):
    """Forward speed and turn rate of a robot with these readings."""
    x = y = 0.0
    for distance, bearing, reach in zip(distances, geometry.bearing, geometry.max_range):
        if distance < reach:
            x -= (1 - distance / reach) * math.cos(bearing)
            y -= (1 - distance / reach) * math.sin(bearing)
    angle = math.atan2(y, x) if x or y else 0.0
    return SPEED * max(0.0, math.cos(angle)), GAIN * angle


def main():
    with coopdyn.connect() as sim:
        team = sim.team(sys.argv[1:] or None)
        geometry = sim.robot(team.names[0]).get_geometry()
        start = s = team.read()
        for k in range(1000):
            s = team.step([away_from(d, geometry) for d in s.distances])
        gone = [math.dist(a[:2], b[:2]) for a, b in zip(start.pose, s.pose)]
        print(f"{team.n} robots went {sum(gone) / team.n:.2f} m on average in {s.time - start.time:.2f} s")


if __name__ == "__main__":
    main()

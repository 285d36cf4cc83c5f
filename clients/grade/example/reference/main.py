"""The reference: through the middle of each gap to the target."""
import math

import coopdyn

GAP = 1.25  # [m] from the centre line of the room to the middle of a gap
WAY = [(-2.2, GAP), (-0.8, GAP), (0.8, -GAP), (2.2, -GAP), (4.0, 0.0)]
NEAR = 0.3  # [m]

sim = coopdyn.connect()
robot = sim.robot("robot1")
pose = robot.get_pose()
for x, y in WAY:
    while math.hypot(x - pose.x, y - pose.y) > NEAR:
        turn = math.remainder(math.atan2(y - pose.y, x - pose.x) - pose.heading, 2 * math.pi)
        robot.set_velocity(0.5 * max(0.0, math.cos(turn)) ** 2, 2.0 * turn)
        sim.step()
        pose = robot.get_pose()
print("arrived")

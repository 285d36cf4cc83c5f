"""A weak solution: straight towards the target, ignoring obstacles."""
import coopdyn

sim = coopdyn.connect()
robot = sim.robot("robot1")
for k in range(1000):
    target = robot.get_target("red")
    robot.set_velocity(0.3, 1.5 * target.bearing)
    sim.step()
print("20 s are over, and the target is still", round(target.distance, 2), "m away")

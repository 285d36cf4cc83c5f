# Your program. It runs on the server and drives in your own simulation.
# Run: Ctrl+Enter. Stop it at any time. What it prints appears below.
import coopdyn

sim = coopdyn.connect()
robot = sim.robot("robot1")

for step in range(600):
    nearest = min(robot.get_distances())   # [m], inf: nothing there
    if nearest < 0.5:
        robot.set_velocity(0.0, 1.0)       # [m/s], [rad/s]: turn on the spot
    else:
        robot.set_velocity(0.3, 0.0)       # drive straight on
    if step % 60 == 0:
        print(f"{sim.time:.1f} s: the nearest thing is {nearest:.2f} m away")
    sim.step()

robot.set_velocity(0.0, 0.0)

# SPDX-License-Identifier: MIT
# Drives robot1 to the red target past obstacles. Runs unchanged in real time and in lockstep.
import coopdyn
sim = coopdyn.connect()                  # "labserver", "labserver:10100"; default: this machine, or COOPDYN_SERVER
r = sim.robot("robot1")
for k in range(2000):
    t = r.get_target("red")              # t.distance [m], t.bearing [rad], left is positive
    if t.distance < 0.4: break
    d = r.get_distances()                # 11 ranges [m], right to left, inf = nothing there
    r.set_velocity(0.3 * min(1, min(d)), 1.5 * t.bearing + 0.4 * (min(d[:5]) < 0.5))
    sim.step()
p = r.get_pose(); print(f"{p.x:.2f} {p.y:.2f} at t = {sim.time:.2f} s"); sim.close()

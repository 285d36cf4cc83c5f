% SPDX-License-Identifier: MIT
% Drives robot1 to the red target past obstacles. Runs unchanged in real time and in lockstep.
sim = coopdyn.connect();
r   = sim.robot("robot1");
for k = 1:2000
    t = r.get_target("red");
    if t.distance < 0.4, break, end
    d = r.get_distances();
    r.set_velocity(0.3 * min(1, min(d)), 1.5 * t.bearing + 0.4 * (min(d(1:5)) < 0.5));
    sim.step();
end
p = r.get_pose(); fprintf("%.2f %.2f at t = %.2f s\n", p.x, p.y, sim.time); sim.close();

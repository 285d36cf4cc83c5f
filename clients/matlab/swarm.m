% SPDX-License-Identifier: MIT
% A swarm that spreads: every robot drives ahead and turns away from near things. Runs in real time and in lockstep.
% Needs free robots: coopdyn serve swarm100
sim  = coopdyn.connect();
team = sim.team();                            % or sim.team('swarm1')
r    = sim.robot(team.names{1});
g    = r.get_geometry();
s    = team.read();
start = s;
for k = 1:1000
    near  = max(0, 1 - s.distances ./ g.max_range);     % n x m, 0 = nothing there
    x     = -near * cos(g.bearing');
    y     = -near * sin(g.bearing');
    angle = atan2(y, x) .* (x ~= 0 | y ~= 0);
    s = team.step([0.1 * max(0, cos(angle)), 2 * angle]);   % forward [m/s], turn [rad/s] for each robot
end
gone = hypot(s.pose(:, 1) - start.pose(:, 1), s.pose(:, 2) - start.pose(:, 2));
fprintf('%d robots went %.2f m on average in %.2f s\n', team.n, mean(gone), s.time - start.time);
sim.close();

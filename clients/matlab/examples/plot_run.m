% SPDX-License-Identifier: MIT
% Draws the paths of the robots of a recorded run. First: sim.fetch_run('lesson1'), or coopdyn export lesson1.run --to mat
run = coopdyn.read_run('lesson1.mat');
for name = run.names
  p = run.pose(name{1});                     % k x 3: x, y [m], heading [rad]
  plot(p(:, 1), p(:, 2), 'DisplayName', name{1}); hold on
end
axis equal; grid on; xlabel('x [m]'); ylabel('y [m]'); legend show

% SPDX-License-Identifier: MIT
function off = square(name)
%SQUARE Draws a square in the air with a robot's arm: square('robot1'). Runs in lockstep and in real time.
%   Returns the tool's greatest distance from the outline [m].
  side_m = 0.2;
  side_s = 2;  % for each side
  if nargin < 1
    name = 'robot1';
  end
  sim = coopdyn.connect();
  robot = sim.robot(name);
  arm = robot.joints();
  % Bend the arm forward, so that the tool can move in all directions: 0.8 rad about each axis that points left.
  chain = arm.get_chain();
  move(sim, arm, 0.8 * round(chain.axes(2, :)));
  pose = arm.forward();
  middle = pose(1:3, 4);

  % The path of the joints: one posture per step, each found near the previous one.
  dt = sim.dt;
  half = side_m / 2;
  steps = round(side_s / dt);
  corners = [-half -half; half -half; half half; -half half; -half -half; half -half];  % y, z
  now = arm.get();
  q = now.position;
  way = zeros(4 * steps + 1, numel(q));
  for k = 0:4 * steps
    side = floor(k / steps) + 1;
    s = smooth(k / steps - (side - 1));
    pose(2:3, 4) = middle(2:3) + ((1 - s) * corners(side, :) + s * corners(side + 1, :))';
    q = arm.inverse(pose, q);
    way(k + 1, :) = q;
  end

  move(sim, arm, way(1, :));
  off = 0;
  began = sim.time;
  while true
    k = round((sim.time - began) / dt) + 2;
    if k > size(way, 1)
      break
    end
    arm.set_positions_direct(way(k, :));
    sim.step();
    s = robot.sense();
    reached = arm.forward(s.joints.(arm.name).position);
    off = max(off, distance(reached(1:3, 4) - middle, half));
  end
  fprintf('a square of %g m in %.2f s, at most %.3f mm off\n', side_m, sim.time - began, 1000 * off);
  sim.close();
end

function s = smooth(s)
% From 0 to 1 with minimum jerk.
  s = s * s * s * (10 - 15 * s + 6 * s * s);
end

function move(sim, arm, q)
  arm.set_positions(q);
  sim.step();
  while ~arm.arrived()
    sim.step();
  end
end

function d = distance(p, half)
% A point on the outline of the square in the plane x = 0, centred at 0.
  over = abs(p(2:3)) - half;
  d = norm(max(over, 0));
  if d == 0
    d = max(over);
  end
  d = norm([p(1) d]);
end

% SPDX-License-Identifier: MIT
function ok = transport(varargin)
%TRANSPORT Teams of two robots carry bars to the targets, past obstacles: transport, or transport('team1', 'team2', ...).
%   The first team goes to the scenario's first target, the second to the second. Leader and helper follow attractor
%   dynamics (Bicho, Louro, Soares, Erlhagen): the leader turns to the target and away from obstacles, as fast as its load
%   follows. The helper knows no target: its heading turns along the bar, and its speed brings the load back to the middle
%   of its support. docs/teams.md has the equations. All languages use the same algorithm and numbers.
  names = cellfun(@char, varargin, 'UniformOutput', false);
  p = parameters();
  sim = coopdyn.connect();
  if isempty(names)
    names = teams_of(sim.robots());
  end
  if isempty(names)
    error('there is no team here; run the daemon with: coopdyn serve transport');
  end
  n = numel(names);
  team = sim.team([strcat(names, '_leader') strcat(names, '_helper')]);  % all through one connection, one row each
  team.select('distances', 'targets', 'support', 'pose');
  [~, front] = ismember(strcat(names, '_leader')', team.names);  % the rows of the leaders
  [~, back] = ismember(strcat(names, '_helper')', team.names);
  sensors = sensors_of(p, team.names, front);
  lead_speed = zeros(n, 1);
  help_speed = zeros(n, 1);
  arrived = inf(1, n);
  number = (0:n - 1)';
  dt = sim.dt;
  left = exp(-p.relaxation * dt);
  s = team.read();
  start = s.time;
  V = zeros(2 * n, 2);
  while s.time - start < p.time_limit && any(s.time - arrived <= p.settle)
    goal = front + 4 * n * mod(number, size(s.targets, 2) / 2);  % index of the target's distance; its bearing is one column to the right
    target = s.targets([goal, goal + 2 * n]);
    bars = along_bars(p, s.support);
    seen = obstacles(p, sensors, s.distances, bars(:, 3));
    [lead_speed, V(front, :)] = lead(p, lead_speed, target, seen(front, :), bars(front, :), left);
    [help_speed, V(back, :)] = help_carry(p, help_speed, seen(back, :), bars(back, :), dt);
    for k = find(target(:, 1).' < p.reached & isinf(arrived))
      arrived(k) = s.time;
      fprintf('%s arrived: %.2f %.2f at t = %.2f s\n', names{k}, s.pose(front(k), 1:2), s.time);
    end
    s = team.step(V);
  end
  for k = find(isinf(arrived))
    fprintf('%s did not arrive in %g s\n', names{k}, p.time_limit);
  end
  sim.close();
  if nargout > 0
    ok = ~any(isinf(arrived));
  end
end

function names = teams_of(robots)
  leads = ~cellfun('isempty', regexp(robots, '_leader$', 'once'));
  names = regexprep(robots(leads), '_leader$', '');
end

function p = parameters()
  p.robot_radius = 0.18;       % [m]
  p.team_distance = 1.2;       % [m] from leader to helper
  p.target_strength = 0.9;     % [rad/s]
  p.bar_strength = 2.5;        % [rad/s] of the helper's turn along the bar
  p.leader_obstacle = 6.0;     % [1/s]
  p.leader_decay = 0.45;       % [m] the leader keeps room for the bar behind it
  p.helper_obstacle = 4.0;     % [1/s]
  p.helper_decay = 0.2;        % [m]
  p.edge = exp(-0.5);          % of a Gaussian
  p.bias = 0.02;               % [rad/s] instead of noise
  p.leader_speed = 0.3;        % [m/s]
  p.leader_turn = 0.8;         % [rad/s]
  p.helper_speed = 0.5;        % [m/s]
  p.helper_turn = 1.8;         % [rad/s]
  p.helper_limits = [p.helper_speed p.helper_turn];
  p.time_to_target = 1.5;      % [s]
  p.time_to_contact = 1.6;     % [s]
  p.relaxation = 2.0;          % [1/s] of the leader's speed
  p.ahead = 0.873;             % [rad]
  p.reached = 0.4;             % [m] from the leader to the target
  p.fold = 1.3;                % [rad] beyond, a robot turns back towards the bar
  p.fold_strength = 4.0;       % [1/s]
  p.follow = 12.0;             % [1/s] speed per displacement of the load along the bar
  p.follow_integral = 8.0;     % [1/s^2]
  p.across = 5.0;              % [rad/s per m] of the load across the bar
  p.slack = 0.055;             % [m] lag of the load at which the leader stops
  p.ease = 0.03;               % [m] the leader slows down from a lag of slack - ease on
  p.mate_width = 0.35;         % [rad] ranges this close to the mate's bearing are the mate
  p.mate_near = 0.25;          % [m] unless they are nearer than the mate by more than this
  p.settle = 2.0;              % [s] for the helpers after the leaders have arrived
  p.time_limit = 180.0;        % [s] simulated
  p.mate_cos = cos(p.mate_width);
  p.mate_from = p.team_distance - 2 * p.robot_radius - p.mate_near;
end

function sensors = sensors_of(p, names, front)
% The distance sensors of these robots, one row each: bearings [rad], and weights of their readings.
  sim = coopdyn.connect('watch', true);
  for k = 1:numel(names)
    r = sim.robot(names{k});
    g = r.get_geometry();
    sensors.bearing(k, :) = g.bearing;
    sensors.half_width(k, :) = tan(g.opening / 2);
  end
  sim.close();
  rows = ones(numel(names), 1);
  sensors.strength = p.helper_obstacle * rows;
  sensors.strength(front) = p.leader_obstacle;
  sensors.decay = p.helper_decay * rows;
  sensors.decay(front) = p.leader_decay;
  sensors.to_mate = sensors.bearing;  % the mate's bearing is the bar's angle; for leaders the opposite
  sensors.to_mate(front, :) = sensors.to_mate(front, :) - pi;
  sensors.aside = abs(sensors.bearing) > p.ahead;
end

function [speed, V] = lead(p, speed, target, seen, bar, left)
% Speeds and turn rates to the targets (distance, bearing), as fast as the loads follow; `left`: remaining share of the old
% speed.
  turn = p.target_strength * sin(target(:, 2)) + p.bias + seen(:, 1);
  turn = max(-p.leader_turn, min(p.leader_turn, turn));
  near = atan(8 * seen(:, 2)) / pi;  % -1/2: nothing near ahead, 1/2: much
  by_target = min(p.leader_speed, target(:, 1) / p.time_to_target) .* max(0.1, cos(target(:, 2) / 2));
  by_obstacles = min(p.leader_speed, seen(:, 3) / p.time_to_contact);
  by_load = max(0, min(1, (p.slack + bar(:, 1)) / p.ease));
  wanted = by_load .* ((0.5 - near) .* by_target + (0.5 + near) .* min(by_target, by_obstacles));
  far = target(:, 1) >= p.reached;  % the others stand still
  speed = far .* (wanted + (speed - wanted) * left);
  V = [speed .* by_load, far .* (turn + bar(:, 4))];
end

function [speed, V] = help_carry(p, speed, seen, bar, dt)
% Speeds and turn rates that follow the loads; `speed`: the leaders' estimated speeds along the bars.
  angle = bar(:, 3);
  turn = p.bar_strength * sin(angle) + p.across * bar(:, 2) + seen(:, 1) + bar(:, 4);
  along = bar(:, 1);
  speed = speed + p.follow_integral * along * dt;
  speed = max(-p.helper_speed, min(p.helper_speed, speed));
  wanted = (speed + p.follow * along) ./ max(0.5, cos(angle));
  V = max(-p.helper_limits, min(p.helper_limits, [wanted, turn]));
end

function seen = obstacles(p, sensors, distances, angle)
% Turn rate, potential and free distance ahead of each robot. Ranges along the bar are the other robot of the team.
  psi = sensors.bearing;
  distances(cos(sensors.to_mate - angle) > p.mate_cos & distances > p.mate_from) = inf;
  weight = sensors.strength .* exp(-distances ./ sensors.decay);  % 0 if the sensor sees nothing
  width = atan(sensors.half_width + p.robot_radius ./ (p.robot_radius + distances));
  gauss = exp(-psi.^2 ./ (2 * width.^2));
  turn = -sum(weight .* psi .* gauss, 2);
  potential = sum(weight .* width.^2 .* (gauss - p.edge), 2);
  distances(sensors.aside) = inf;
  seen = [turn, potential, min(distances, [], 2)];
end

function bars = along_bars(p, load)
% Displacements of the loads (x, y, angle) along and across their bars, the angle, and the turn rate back towards the bar if
% the heading deviates too far from it.
  x = load(:, 1);
  y = load(:, 2);
  angle = load(:, 3);
  c = cos(angle);
  s = sin(angle);
  unfold = p.fold_strength * (angle - max(-p.fold, min(p.fold, angle)));
  bars = [x .* c + y .* s, y .* c - x .* s, angle, unfold];
end

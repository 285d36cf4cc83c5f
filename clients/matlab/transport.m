% SPDX-License-Identifier: MIT
function ok = transport(varargin)
%TRANSPORT Teams of two carry their bars to the targets, past obstacles: transport, or transport('team1', 'team2', ...).
%   The first team goes to the scenario's first target, the second to the second. Leader and helper are attractor
%   dynamics (Bicho, Louro, Soares, Erlhagen): the leader turns to the target and away from obstacles, as fast as its
%   load follows; the helper knows no target: its heading turns along the bar, its speed brings the load back to the
%   middle of its support. docs/teams.md has the equations. The same algorithm and numbers in all languages.
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
  team = sim.team([strcat(names, '_leader') strcat(names, '_helper')]);  % all through one connection, a row for each
  team.select('distances', 'targets', 'support', 'pose');
  [~, front] = ismember(strcat(names, '_leader'), team.names);
  [~, back] = ismember(strcat(names, '_helper'), team.names);
  leaders = geometry_of(team.names(front));
  helpers = geometry_of(team.names(back));
  speed = zeros(2 * n, 1);
  arrived = inf(1, n);
  dt = sim.dt;
  s = team.read();
  start = s.time;
  V = zeros(2 * n, 2);
  while s.time - start < p.time_limit && any(s.time - arrived <= p.settle | isinf(arrived))
    goal = 2 * mod((1:n) - 1, size(s.targets, 2) / 2) + 1;  % the column of its distance
    goal = sub2ind(size(s.targets), front, goal);
    target = [s.targets(goal).' s.targets(goal + size(s.targets, 1)).'];
    [speed(front), V(front, :)] = lead(p, leaders, speed(front), target, s.distances(front, :), ...
                                       s.support(front, :), dt);
    [speed(back), V(back, :)] = help_carry(p, helpers, speed(back), s.distances(back, :), s.support(back, :), dt);
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
  p.bar_strength = 2.5;        % [rad/s] by which the helper turns along the bar
  p.leader_obstacle = 6.0;     % [1/s]
  p.leader_decay = 0.45;       % [m] the leader keeps room for the bar behind it
  p.helper_obstacle = 4.0;     % [1/s]
  p.helper_decay = 0.2;        % [m]
  p.bias = 0.02;               % [rad/s] instead of noise
  p.leader_speed = 0.3;        % [m/s]
  p.helper_speed = 0.5;        % [m/s]
  p.leader_turn = 0.8;         % [rad/s]
  p.helper_turn = 1.8;         % [rad/s]
  p.time_to_target = 1.5;      % [s]
  p.time_to_contact = 1.6;     % [s]
  p.relaxation = 2.0;          % [1/s] of the leader's speed
  p.ahead = 0.873;             % [rad]
  p.reached = 0.4;             % [m] from the leader to the target
  p.fold = 1.3;                % [rad] beyond, a robot turns back towards the bar
  p.fold_strength = 4.0;       % [1/s]
  p.follow = 12.0;             % [1/s] speed per way of the load along the bar
  p.follow_integral = 8.0;     % [1/s^2]
  p.across = 5.0;              % [rad/s per m] of the load across the bar
  p.slack = 0.055;             % [m] the leader stands when the load lags so far behind
  p.ease = 0.03;               % [m] it slows down from slack - ease on
  p.mate_width = 0.35;         % [rad] ranges about the mate's bearing are the mate
  p.mate_near = 0.25;          % [m] unless they are nearer than it by so much
  p.settle = 2.0;              % [s] the helpers have after the leaders have arrived
  p.time_limit = 180.0;        % [s] simulated
end

function geometry = geometry_of(names)
% Where the distance sensors of these robots look and how wide [rad], a row for each.
  sim = coopdyn.connect('watch', true);
  for k = 1:numel(names)
    r = sim.robot(names{k});
    g = r.get_geometry();
    geometry.bearing(k, :) = g.bearing;
    geometry.opening(k, :) = g.opening;
  end
  sim.close();
end

function [speed, V] = lead(p, geometry, speed, target, distances, load, dt)
% Speeds and turn rates to the targets (distance, bearing), as fast as the loads (x, y, angle) follow.
  [away, potential, free] = obstacles(p, geometry, distances, p.leader_obstacle, p.leader_decay, load(:, 3) + pi);
  turn = clamp(p.target_strength * sin(target(:, 2)) + p.bias + away, -p.leader_turn, p.leader_turn);
  near = atan(8 * potential) / pi;  % -1/2: nothing near ahead, 1/2: much
  by_target = min(p.leader_speed, target(:, 1) / p.time_to_target) .* max(0.1, cos(target(:, 2) / 2));
  by_obstacles = min(p.leader_speed, free / p.time_to_contact);
  by_load = clamp((p.slack + along(load)) / p.ease, 0, 1);
  wanted = by_load .* ((0.5 - near) .* by_target + (0.5 + near) .* min(by_target, by_obstacles));
  far = target(:, 1) >= p.reached;  % the others stand
  speed = far .* (wanted + (speed - wanted) * exp(-p.relaxation * dt));
  V = [speed .* by_load, far .* (turn + unfold(p, load(:, 3)))];
end

function [speed, V] = help_carry(p, geometry, speed, distances, load, dt)
% Speeds and turn rates that follow the loads; `speed`: what the leaders seem to drive along the bars.
  angle = load(:, 3);
  away = obstacles(p, geometry, distances, p.helper_obstacle, p.helper_decay, angle);
  across = load(:, 2) .* cos(angle) - load(:, 1) .* sin(angle);
  turn = p.bar_strength * sin(angle) + p.across * across + away + unfold(p, angle);
  speed = clamp(speed + p.follow_integral * along(load) * dt, -p.helper_speed, p.helper_speed);
  wanted = (speed + p.follow * along(load)) ./ max(0.5, cos(angle));
  V = [clamp(wanted, -p.helper_speed, p.helper_speed), clamp(turn, -p.helper_turn, p.helper_turn)];
end

function [turn, potential, free] = obstacles(p, geometry, distances, strength, decay, mate)
% What is seen at the bearing `mate` is the other robot of the team.
  psi = geometry.bearing;
  off = mod(psi - mate + pi, 2 * pi) - pi;
  distances(abs(off) < p.mate_width & distances > p.team_distance - 2 * p.robot_radius - p.mate_near) = inf;
  weight = strength * exp(-distances / decay);  % 0 where nothing is
  width = atan(tan(geometry.opening / 2) + p.robot_radius ./ (p.robot_radius + distances));
  gauss = exp(-psi.^2 ./ (2 * width.^2));
  turn = -sum(weight .* psi .* gauss, 2);
  potential = sum(weight .* width.^2 .* (gauss - exp(-0.5)), 2);
  distances(abs(psi) > p.ahead) = inf;
  free = min(distances, [], 2);
end

function a = along(load)
  a = load(:, 1) .* cos(load(:, 3)) + load(:, 2) .* sin(load(:, 3));
end

function turn = unfold(p, angle)
% Turns back towards the bar if the heading is too far from it.
  turn = p.fold_strength * sign(angle) .* max(0, abs(angle) - p.fold);
end

function value = clamp(value, low, high)
  value = max(low, min(high, value));
end

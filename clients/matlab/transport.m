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
  front = cell(1, n);
  back = cell(1, n);
  front_geometry = cell(1, n);
  back_geometry = cell(1, n);
  for k = 1:n
    front{k} = sim.robot([names{k} '_leader']);
    back{k} = sim.robot([names{k} '_helper']);
    r = front{k};
    front_geometry{k} = r.get_geometry();
    r = back{k};
    back_geometry{k} = r.get_geometry();
  end
  leader_speed = zeros(1, n);
  helper_speed = zeros(1, n);
  arrived = inf(1, n);
  dt = sim.dt;
  start = sim.time;
  now = start;
  while now - start < p.time_limit && any(now - arrived <= p.settle | isinf(arrived))
    for k = 1:n
      r = front{k};
      s = r.sense();
      target = s.targets(mod(k - 1, numel(s.targets)) + 1);
      [leader_speed(k), v, w] = lead(p, front_geometry{k}, leader_speed(k), target, s.distances, s.support, dt);
      r.set_velocity(v, w);
      if target.distance < p.reached && isinf(arrived(k))
        arrived(k) = s.time;
        fprintf('%s arrived: %.2f %.2f at t = %.2f s\n', names{k}, s.pose.x, s.pose.y, s.time);
      end
      r = back{k};
      s = r.sense();
      [helper_speed(k), v, w] = help_carry(p, back_geometry{k}, helper_speed(k), s.distances, s.support, dt);
      r.set_velocity(v, w);
      now = s.time;
    end
    sim.step();
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

function [speed, v, w] = lead(p, geometry, speed, target, distances, load, dt)
% Speed and turn rate to the target, as fast as the load follows.
  if target.distance < p.reached
    speed = 0;
    v = 0;
    w = 0;
    return
  end
  [away, potential, free] = obstacles(p, geometry, distances, p.leader_obstacle, p.leader_decay, load.angle + pi);
  turn = clamp(p.target_strength * sin(target.bearing) + p.bias + away, -p.leader_turn, p.leader_turn);
  near = atan(8 * potential) / pi;  % -1/2: nothing near ahead, 1/2: much
  by_target = min(p.leader_speed, target.distance / p.time_to_target) * max(0.1, cos(target.bearing / 2));
  by_obstacles = min(p.leader_speed, free / p.time_to_contact);
  by_load = clamp((p.slack + along(load)) / p.ease, 0, 1);
  wanted = by_load * ((0.5 - near) * by_target + (0.5 + near) * min(by_target, by_obstacles));
  speed = wanted + (speed - wanted) * exp(-p.relaxation * dt);
  v = speed * by_load;
  w = turn + unfold(p, load.angle);
end

function [speed, v, w] = help_carry(p, geometry, speed, distances, load, dt)
% Speed and turn rate that follow the load; `speed`: what the leader seems to drive along the bar.
  away = obstacles(p, geometry, distances, p.helper_obstacle, p.helper_decay, load.angle);
  across = load.y * cos(load.angle) - load.x * sin(load.angle);
  turn = p.bar_strength * sin(load.angle) + p.across * across + away + unfold(p, load.angle);
  speed = clamp(speed + p.follow_integral * along(load) * dt, -p.helper_speed, p.helper_speed);
  wanted = (speed + p.follow * along(load)) / max(0.5, cos(load.angle));
  v = clamp(wanted, -p.helper_speed, p.helper_speed);
  w = clamp(turn, -p.helper_turn, p.helper_turn);
end

function [turn, potential, free] = obstacles(p, geometry, distances, strength, decay, mate)
% What is seen at the bearing `mate` is the other robot of the team.
  off = mod(geometry.bearing - mate + pi, 2 * pi) - pi;
  is_mate = abs(off) < p.mate_width & distances > p.team_distance - 2 * p.robot_radius - p.mate_near;
  sees = isfinite(distances) & ~is_mate;
  d = distances(sees);
  psi = geometry.bearing(sees);
  weight = strength * exp(-d / decay);
  width = atan(tan(geometry.opening(sees) / 2) + p.robot_radius ./ (p.robot_radius + d));
  gauss = exp(-psi.^2 ./ (2 * width.^2));
  turn = -sum(weight .* psi .* gauss);
  potential = sum(weight .* width.^2 .* (gauss - exp(-0.5)));
  free = min([inf, d(abs(psi) <= p.ahead)]);
end

function a = along(load)
  a = load.x * cos(load.angle) + load.y * sin(load.angle);
end

function turn = unfold(p, angle)
% Turns back towards the bar if the heading is too far from it.
  turn = 0;
  if abs(angle) > p.fold
    turn = p.fold_strength * (angle - sign(angle) * p.fold);
  end
end

function value = clamp(value, low, high)
  value = max(low, min(high, value));
end

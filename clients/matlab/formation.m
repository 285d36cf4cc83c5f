% SPDX-License-Identifier: MIT
function ok = formation(varargin)
%FORMATION Robots keep a formation round obstacles on the way to the red target: formation, or formation('robot1', ...).
%   The first robot leads. Five keep an inverted V, three a triangle; near obstacles they break the formation and restore it
%   behind them. Attractor dynamics (Monteiro, Bicho): a follower turns towards its place, which moves with the leader, and
%   away from obstacles. docs/teams.md has the equations. All languages use the same algorithm and numbers.
  names = cellfun(@char, varargin, 'UniformOutput', false);
  p = parameters();
  sim = coopdyn.connect();
  if isempty(names)
    names = sim.robots();
  end
  n = numel(names);
  robots = cell(1, n);
  geometries = cell(1, n);
  places = zeros(n, 2);
  for k = 1:n
    robots{k} = sim.robot(names{k});
    r = robots{k};
    geometries{k} = r.get_geometry();
    places(k, :) = place_of(p, k - 1, n);
  end
  speeds = zeros(1, n);
  told = [0 0];  % the leader's command
  result = false;
  dt = sim.dt;
  start = sim.time;
  now = start;
  while now - start < p.time_limit
    seen = cell(1, n);
    poses = zeros(n, 3);
    for k = 1:n
      r = robots{k};
      s = r.sense('red');
      seen{k} = s;
      poses(k, :) = [s.pose.x s.pose.y s.pose.heading];
    end
    now = seen{1}.time;
    carried = poses(1, 1:2) + turned(places, poses(1, 3)) - poses(:, 1:2);
    worst = max(sqrt(sum(carried.^2, 2)));
    target = seen{1}.target;
    if target.distance < p.reached && worst < p.closed
      fprintf('the formation reached the target, %.1f cm off, at t = %.2f s\n', 100 * worst, now);
      result = true;
      break
    end
    for k = 1:n
      if k == 1
        [speeds(k), w] = lead(p, geometries{k}, speeds(k), target, worst, seen{k}.distances, dt);
        told = [speeds(k) w];
      else
        off = turned(carried(k, :), -poses(k, 3));
        moves = [told(1) - told(2) * places(k, 2), told(2) * places(k, 1)];
        moves = turned(moves, poses(1, 3) - poses(k, 3));
        [speeds(k), w] = follow(p, geometries{k}, speeds(k), off, moves, seen{k}.distances, dt);
      end
      r = robots{k};
      r.set_velocity(speeds(k), w);
    end
    sim.step();
  end
  if ~result
    fprintf('the formation did not reach the target in %g s\n', p.time_limit);
  end
  sim.close();
  if nargout > 0
    ok = result;
  end
end

function p = parameters()
  p.robot_radius = 0.18;       % [m]
  p.target_strength = 1.2;     % [rad/s]
  p.place_strength = 2.5;      % [rad/s] of a follower towards its place
  p.obstacle_strength = 10.0;  % [1/s]
  p.obstacle_decay = 0.2;      % [m]
  p.bias = 0.02;               % [rad/s] instead of noise
  p.leader_speed = 0.3;        % [m/s]
  p.follower_speed = 0.6;      % [m/s]
  p.max_turn = 1.8;            % [rad/s]
  p.time_to_target = 1.5;      % [s]
  p.time_to_contact = 1.2;     % [s]
  p.relaxation = 8.0;          % [1/s] of the speed
  p.ahead = 0.873;             % [rad]
  p.reached = 0.4;             % [m] from the leader to the target
  p.pull = 0.8;                % [1/s] speed per distance to the place
  p.near = 0.04;               % [m] nearer to its place a robot is not pulled
  p.calm = 0.05;               % [m/s] a slower wanted velocity turns the robot less
  p.away = 0.25;               % least share of the wanted speed while an obstacle turns the robot away
  p.patience = 0.3;            % [m] the leader slows down when a robot is farther from its place
  p.slowest = 0.2;             % share of its speed, at twice that distance
  p.v_along = 1.0;             % [m] from row to row of the inverted V
  p.v_across = 1.0;            % [m] from the middle to its first row
  p.triangle_along = 1.04;     % [m] of three robots
  p.triangle_across = 0.6;     % [m]
  p.closed = 0.1;              % [m] largest distance of a robot from its place at the end
  p.time_limit = 240.0;        % [s] simulated
end

function place = place_of(p, number, count)
% The place of robot `number`, from 0, in the leader's frame.
  along = p.v_along;
  across = p.v_across;
  if count == 3
    along = p.triangle_along;
    across = p.triangle_across;
  end
  row = floor((number + 1) / 2);
  side = 1;
  if mod(number, 2) == 0
    side = -1;
  end
  place = [-along * row, side * across * row];
end

function xy = turned(xy, angle)
% Rows of x y, turned to the left.
  xy = xy * [cos(angle) sin(angle); -sin(angle) cos(angle)];
end

function [speed, turn] = lead(p, geometry, speed, target, worst, distances, dt)
% Speed and turn rate to the target; `worst`: the greatest distance of a follower from its place [m].
  if target.distance < p.reached
    speed = 0;
    turn = 0;
    return
  end
  [away, potential, free] = obstacles(p, geometry, distances);
  turn = clamp(p.target_strength * sin(target.bearing) + p.bias + away, -p.max_turn, p.max_turn);
  patience = clamp(2 - worst / p.patience, p.slowest, 1);
  by_target = min(patience * p.leader_speed, target.distance / p.time_to_target) * max(0.1, cos(target.bearing / 2));
  speed = relax(p, speed, by_target, potential, free, dt);
end

function [speed, turn] = follow(p, geometry, speed, off, moves, distances, dt)
% Speed and turn rate to the place, which is at `off` and moves by `moves`, both in this robot's frame.
  pull = p.pull * max(0, 1 - p.near / max(norm(off), 1e-9));
  wished = moves + pull * off;
  wish = norm(wished);
  bearing = atan2(wished(2), wished(1));
  [away, potential, free] = obstacles(p, geometry, distances);
  turn = min(1, wish / p.calm) * (p.place_strength * sin(bearing) + away);
  turn = clamp(turn, -p.max_turn, p.max_turn);
  speed = relax(p, speed, min(wish * max(p.away, cos(bearing)), p.follower_speed), potential, free, dt);
end

function [turn, potential, free] = obstacles(p, geometry, distances)
  sees = isfinite(distances);
  d = distances(sees);
  psi = geometry.bearing(sees);
  weight = p.obstacle_strength * exp(-d / p.obstacle_decay);
  width = atan(tan(geometry.opening(sees) / 2) + p.robot_radius ./ (p.robot_radius + d));
  gauss = exp(-psi.^2 ./ (2 * width.^2));
  turn = -sum(weight .* psi .* gauss);
  potential = sum(weight .* width.^2 .* (gauss - exp(-0.5)));
  free = min([inf, d(abs(psi) <= p.ahead)]);
end

function speed = relax(p, speed, wanted, potential, free, dt)
  near = atan(8 * potential) / pi;  % -1/2: nothing near ahead, 1/2: much
  wanted = (0.5 - near) * wanted + (0.5 + near) * min(wanted, free / p.time_to_contact);
  speed = wanted + (speed - wanted) * exp(-p.relaxation * dt);
end

function value = clamp(value, low, high)
  value = max(low, min(high, value));
end

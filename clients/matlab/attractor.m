% SPDX-License-Identifier: MIT
function ok = attractor(varargin)
%ATTRACTOR Drives robots to the red target past obstacles: attractor, or attractor('robot1', 'robot2', ...).
%   The heading is a dynamical system (Schoener, Dose, Engels; Bicho): the target's bearing attracts it, and every distance
%   sensor that sees something near repels it,
%     dphi/dt = -l_tar sin(phi - psi_tar) + sum_i l_i (phi - psi_i) exp(-(phi - psi_i)^2 / (2 s_i^2)),
%     l_i = b1 exp(-d_i / b2),   s_i = atan(tan(opening_i / 2) + R / (R + d_i)),
%   and the speed relaxes to the value that the target or the obstacles allow, weighted by the repulsion's potential at the
%   present heading. Angles are relative to the robot, so phi = 0. All three languages use the same algorithm and numbers.
  names = cellfun(@char, varargin, 'UniformOutput', false);
  if isempty(names)
    names = {'robot1'};
  end
  p = parameters();
  reached_at = p.reached;
  if numel(names) > 1
    reached_at = p.reached_by_many;
  end
  sim = coopdyn.connect();
  n = numel(names);
  robots = cell(1, n);
  geometries = cell(1, n);
  for k = 1:n
    robots{k} = sim.robot(names{k});
    r = robots{k};
    geometries{k} = r.get_geometry();
  end
  speeds = zeros(1, n);
  driving = true(1, n);
  dt = sim.dt;
  start = sim.time;
  while any(driving) && sim.time - start < p.time_limit
    for k = find(driving)
      r = robots{k};
      s = r.sense('red');
      if s.target.distance < reached_at
        r.stop();
        driving(k) = false;
        fprintf('%s reached the target: %.2f %.2f at t = %.2f s\n', names{k}, s.pose.x, s.pose.y, s.time);
      else
        [speeds(k), turn] = command(p, geometries{k}, speeds(k), s.target, s.distances, dt);
        r.set_velocity(speeds(k), turn);
      end
    end
    sim.step();
  end
  for k = find(driving)
    fprintf('%s did not reach the target in %g s\n', names{k}, p.time_limit);
  end
  sim.close();
  result = ~any(driving);
  if nargout > 0
    ok = result;
  end
end

function p = parameters()
  p.robot_radius = 0.18;      % [m]
  p.target_strength = 1.6;    % [rad/s]
  p.obstacle_strength = 10;   % b1 [1/s]
  p.obstacle_decay = 0.3;     % b2 [m]
  p.bias = 0.02;              % [rad/s] instead of noise: turns off a heading exactly between left and right
  p.max_speed = 0.5;          % [m/s]
  p.max_turn = 1.8;           % [rad/s]
  p.time_to_target = 1.5;     % [s] limits the speed by the target's distance
  p.time_to_contact = 1.2;    % [s] limits the speed by the distance of obstacles ahead
  p.ahead = 50 * pi / 180;    % sensors within this bearing are ahead
  p.relaxation = 8;           % [1/s] of the speed
  p.reached = 0.4;            % [m] from the axle's midpoint to the target
  p.reached_by_many = 0.9;    % [m] if several robots share it
  p.time_limit = 180;         % [s] simulated
end

function [speed, turn] = command(p, geometry, speed, target, distances, dt)
% Speed [m/s] and turn rate [rad/s] for the next dt [s].
  sees = isfinite(distances);
  d = distances(sees);
  psi = geometry.bearing(sees);
  strength = p.obstacle_strength * exp(-d / p.obstacle_decay);
  width = atan(tan(geometry.opening(sees) / 2) + p.robot_radius ./ (p.robot_radius + d));
  gauss = exp(-psi.^2 ./ (2 * width.^2));
  turn = p.target_strength * sin(target.bearing) + p.bias - sum(strength .* psi .* gauss);
  turn = max(-p.max_turn, min(p.max_turn, turn));
  potential = sum(strength .* width.^2 .* (gauss - exp(-0.5)));
  near = atan(8 * potential) / pi;  % -1/2: nothing near ahead, 1/2: much
  free = min([inf, d(abs(psi) <= p.ahead)]);
  by_target = min(p.max_speed, target.distance / p.time_to_target) * max(0.1, cos(target.bearing / 2));
  by_obstacles = min(p.max_speed, free / p.time_to_contact);
  wanted = (0.5 - near) * by_target + (0.5 + near) * min(by_target, by_obstacles);
  speed = wanted + (speed - wanted) * exp(-p.relaxation * dt);
end

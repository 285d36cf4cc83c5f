% SPDX-License-Identifier: MIT
function wall(name, duration)
%WALL Follows the wall on the right using a lidar: wall, wall('robot1') or wall('robot1', 60), for 60 s.
%   Scenario wall. Two rays see the wall: b to the right, and a, turned ahead by the angle theta. They yield the robot's
%   heading relative to the wall, its distance from the wall (or from the nearest thing on the right), and this distance
%   after l more metres,
%     alpha = atan2(a cos(theta) - b, a sin(theta)),   d = b cos(alpha),   d_ahead = d + l sin(alpha).
%   The turn rate controls d_ahead to the desired distance; near things ahead make the robot slow down and turn left.
%   All three languages use the same algorithm and numbers.
  if nargin < 1
    name = 'robot1';
  end
  if nargin < 2
    duration = 60;
  end
  p = parameters();
  sim = coopdyn.connect();
  r = sim.robot(name);
  start = sim.time;
  s = r.sense();
  near = 0;
  steps = 0;
  least = Inf;
  while s.time - start < duration
    [speed, turn, distance] = command(p, s.scan);
    r.set_velocity(speed, turn);
    steps = steps + 1;
    near = near + (abs(distance - p.wall_distance) < 0.1);
    least = min([least; s.scan.ranges(:)]);
    sim.step();
    s = r.sense();
  end
  fprintf('%s kept the wall within 0.1 m of %g m for %.0f %% of the time, and %.3f m from everything\n', name, ...
          p.wall_distance, 100 * near / steps, least);
  sim.close();
end

function p = parameters()
  p.wall_distance = 0.5;  % [m] from the lidar
  p.side = 1.5707963;     % [rad] bearing of b, to the right
  p.ahead_by = 0.7;       % theta [rad]
  p.look_ahead = 0.5;     % l [m]
  p.gain = 4.0;           % [rad/s/m]
  p.speed = 0.2;          % [m/s]
  p.max_turn = 1.0;       % [rad/s]
  p.max_sine = 0.25;      % of alpha
  p.right = 1.05;         % [rad] to either side of b: the search for the wall
  p.free = 0.7;           % [m] the robot turns if something ahead is nearer
  p.cone = 0.35;          % [rad] to either side of ahead
  p.seen = 2.0;           % [m] longer ranges are clamped to this
end

function range = ray(p, scan, bearing)
% The range [m] of the ray nearest to a bearing [rad], in the middle row.
  [~, k] = min(off(scan.azimuth - bearing));
  range = min(p.seen, scan.ranges(floor(numel(scan.elevation) / 2) + 1, k));
end

function range = nearest(p, scan, bearing, cone)
% The shortest range [m] of the rays within `cone` of a bearing [rad], in the middle row.
  row = scan.ranges(floor(numel(scan.elevation) / 2) + 1, :);
  range = min([p.seen, row(off(scan.azimuth - bearing) <= cone)]);
end

function angle = off(angle)
% The magnitude of an angle, without whole turns [rad].
  angle = abs(angle - 2 * pi * round(angle / (2 * pi)));
end

function [speed, turn, distance] = command(p, scan)
% Speed [m/s], turn rate [rad/s], and the present distance of the wall [m].
  a = ray(p, scan, p.ahead_by - p.side);
  b = ray(p, scan, -p.side);
  alpha = atan2(a * cos(p.ahead_by) - b, a * sin(p.ahead_by));
  distance = min(b * cos(alpha), nearest(p, scan, -p.side, p.right));
  free = nearest(p, scan, 0, p.cone);
  turn = p.gain * (p.wall_distance - (distance + p.look_ahead * max(-p.max_sine, min(p.max_sine, sin(alpha)))));
  speed = p.speed;
  turn = max(-p.max_turn, min(p.max_turn, turn));
  if free < p.free
    speed = p.speed * max(0, free / p.free - 0.4);
    turn = p.max_turn;
  end
end

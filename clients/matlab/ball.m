% SPDX-License-Identifier: MIT
function ball(name, duration)
%BALL Follows a red ball by a camera: ball, ball('robot1') or ball('robot1', 30), for 30 s.
%   Scenario ball. The ball's pixels are those with much more red than green and blue. Their centre gives the bearing, their
%   number n the distance: a ball of radius R at distance d covers pi (f R / d)^2 pixels, so d = f R sqrt(pi / n). The robot
%   turns towards the ball and keeps its distance; without a ball in view it turns to the side where it saw the ball last.
%   All three languages use the same algorithm and numbers.
  if nargin < 1
    name = 'robot1';
  end
  if nargin < 2
    duration = 30;
  end
  p = parameters();
  sim = coopdyn.connect();
  r = sim.robot(name);
  camera = r.get_camera();
  start = sim.time;
  side = 1;
  seen = 0;
  pictures = 0;
  distance = Inf;
  bearing = 0;
  while sim.time - start < duration
    [d, b] = look(p, r.get_image(), camera);
    pictures = pictures + 1;
    if isempty(d)
      r.set_velocity(0, p.search * side);
    else
      seen = seen + 1;
      distance = d;
      bearing = b;
      side = 1;
      if bearing < 0
        side = -1;
      end
      r.set_velocity(max(-p.max_speed, min(p.max_speed, p.approach * (distance - p.keep))), ...
                     max(-p.max_turn, min(p.max_turn, p.steer * bearing)));
    end
    sim.step();
  end
  fprintf('%s saw the ball in %.0f %% of %d pictures, at last %.3f m away and %.2f degrees to the left\n', name, ...
          100 * seen / pictures, pictures, distance, bearing * 180 / pi);
  sim.close();
end

function p = parameters()
  p.ball_radius = 0.12;  % R [m]
  p.keep = 0.8;          % [m] from the camera to the ball
  p.approach = 1.0;      % [1/s] speed per metre of distance error
  p.max_speed = 0.4;     % [m/s]
  p.steer = 2.0;         % [1/s] turn rate per radian of bearing
  p.max_turn = 1.5;      % [rad/s]
  p.search = 0.8;        % [rad/s] without a ball in view
  p.red = 60;            % minimal red of a red pixel
  p.more = 2;            % minimal ratio of red to green, and of red to blue
  p.columns = 80;        % sampled columns: every fourth pixel of a picture 320 wide
  p.few = 6;             % fewer red pixels are no ball
end

function [distance, bearing] = look(p, image, camera)
% Distance [m] and bearing [rad] of the ball; [] if not in view.
  distance = [];
  bearing = [];
  every = max(1, floor(size(image, 2) / p.columns));
  image = double(image(1:every:end, 1:every:end, :));
  red = image(:, :, 1);
  [~, x] = find(red >= p.red & red >= p.more * image(:, :, 2) & red >= p.more * image(:, :, 3));
  count = numel(x);
  if count < p.few
    return
  end
  middle = every * sum(x - 1) / count + 0.5;
  distance = camera.fx * p.ball_radius * sqrt(pi / count) / every;
  bearing = atan2(camera.cx - middle, camera.fx);
end

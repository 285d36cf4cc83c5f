% SPDX-License-Identifier: MIT
% needs: nothing
% Forward and inverse kinematics of chains made by hand: a closed form, sliders, random postures of seven axes, limits.
translation = @(x, y, z) [eye(3) [x; y; z]; 0 0 0 1];
planar = @(varargin) coopdyn.Chain([0 0], [0 0 0; 0.4 0 0], [0 0 1; 0 0 1], translation(0.7, 0, 0), varargin{:});

chain = planar();
for q = [0 0.3 -1.2 3; 0 0.5 2 -0.4]
  s = sin(sum(q));
  c = cos(sum(q));
  expected = [c -s 0 0.4 * cos(q(1)) + 0.3 * c; s c 0 0.4 * sin(q(1)) + 0.3 * s; 0 0 1 0; 0 0 0 1];
  assert(norm(chain.forward(q) - expected) < 1e-14);
end

sliding = coopdyn.Chain([0 1], zeros(2, 3), [0 0 2; 1 0 0], translation(0.1, 0, 0.5));
assert(norm(sliding.forward([pi / 2 0.2]) - [0 -1 0 0; 1 0 0 0.3; 0 0 1 0.5; 0 0 0 1]) < 1e-14);
carrying = coopdyn.Chain([1 0], zeros(2, 3), [0 0 1; 0 1 0], translation(0.5, 0, 0));
assert(norm(carrying.forward([0.3 pi / 2]) - [0 0 1 0; 0 1 0 0; -1 0 0 -0.2; 0 0 0 1]) < 1e-14);

% Seven axes z y z y z y z of an arm that stands upright.
heights = [0.1 0.3 0.45 0.63 0.8 0.95 1.02]';
limits = [3.1 2 3.1 2 3.1 2 6.2];
axes = repmat([0 0 1], 7, 1);
axes(2:2:6, :) = repmat([0 1 0], 3, 1);
arm = coopdyn.Chain(zeros(1, 7), [zeros(7, 2) heights], axes, translation(0, 0, 1.1), -limits, limits);
rand('seed', 1);
for k = 1:20
  X = arm.forward((2 * rand(1, 7) - 1) .* limits);
  q = arm.inverse(X, 0.1 * ones(1, 7));
  assert(norm(arm.forward(q) - X) < 1e-6);
  assert(all(abs(q) <= limits));
end
X = arm.forward([0.3 0.6 0.2 0.9 0.1 -0.7 0]);
turned = arm.forward([0.3 0.6 0.2 0.9 0.1 -0.7 pi]);
assert(norm(arm.forward(arm.inverse(turned, arm.inverse(X))) - turned) < 1e-6);
assert(isequal(arm.inverse(X), arm.inverse(X)));

% Two postures: the one near the start, or the one within the limits.
for elbow = [0.8 -0.8]
  q = chain.inverse(chain.forward([0.3 elbow]), [0.25 0.9 * elbow]);
  assert(norm(q - [0.3 elbow]) < 1e-6);
end
limited = planar([-3 0.1], [3 3]);
assert(norm(limited.inverse(chain.forward([0.3 0.8]), [0.9 0.1]) - [0.3 0.8]) < 1e-6);
X = chain.forward(chain.inverse([0.2 0.5 0], [0.1 0.1]));
assert(norm(X(1:3, 4) - [0.2; 0.5; 0]) < 1e-6);

expect_error('coopdyn:out_of_range', @() chain.inverse([1 0 0]), 'the nearest is 0.3 m off');
forbidden = planar([0 0], [0.5 0.5]);
expect_error('coopdyn:out_of_range', @() forbidden.inverse([0 -0.5 0]));
expect_error('coopdyn:wrong_data', @() chain.forward([1 2 3]), '3 values, the chain 2 joints');
expect_error('coopdyn:out_of_range', @() chain.forward([1 NaN]), 'must be finite');
expect_error('coopdyn:wrong_data', @() chain.inverse([1 2]), 'a 4 x 4 matrix');
expect_error('coopdyn:out_of_range', @() chain.inverse(diag([2 1 1 1])), 'rotation');
expect_error('coopdyn:out_of_range', @() coopdyn.Chain(0, [0 0 0], [0 0 0], eye(4)), 'direction');
expect_error('coopdyn:wrong_data', @() coopdyn.Chain([0 0], [0 0 0], [0 0 1], eye(4)), '2 joints');
disp('passed');

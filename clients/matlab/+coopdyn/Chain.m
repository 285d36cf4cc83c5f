% SPDX-License-Identifier: MIT
classdef Chain
%CHAIN Forward and inverse kinematics of a serial chain of joints, from a base to a tool. Needs no daemon.
%   The chain as product of exponentials: X(q) = exp([S1] q1) ... exp([Sn] qn) X(0) (Lynch and Park, Modern Robotics,
%   4.1). arm.get_chain() returns that of a robot's arm. Your own chain:
%     chain = coopdyn.Chain(kinds, points, axes, tool, lower, upper)
%   kinds: 0 hinge or 1 slider, per joint; points: n x 3, a point on each axis [m]; axes: n x 3, its direction, both in the
%   base frame with all joints at 0; tool: the tool's pose in this frame, a 4 x 4 matrix; lower, upper: limits [rad, m].
  properties (SetAccess = private)
    kinds
    points  % 3 x n, as axes
    axes
    tool
    lower
    upper
  end
  methods
    function c = Chain(kinds, points, axes, tool, lower, upper)
      n = numel(kinds);
      if nargin < 5, lower = -Inf(1, n); end
      if nargin < 6, upper = Inf(1, n); end
      if ~isequal(size(points), [n 3]) || ~isequal(size(axes), [n 3]) || numel(lower) ~= n || numel(upper) ~= n
        coopdyn.internal.fail(3, sprintf('a chain of %d joints has %d points, %d axes and %d limits', n, n, n, n));
      end
      lengths = sqrt(sum(axes .^ 2, 2));
      if ~all(lengths > 0 & isfinite(lengths))
        coopdyn.internal.fail(4, 'an axis is a direction: its length is not 0');
      end
      c.kinds = reshape(double(kinds), 1, []);
      c.points = double(points)';
      c.axes = (double(axes) ./ lengths)';
      c.tool = checked_pose(tool);
      c.lower = reshape(double(lower), 1, []);
      c.upper = reshape(double(upper), 1, []);
    end

    function X = forward(c, q)
    %FORWARD The tool's pose in the base frame, a 4 x 4 matrix, with the joints at q [rad, m].
      coopdyn.internal.need(nargin, 2, 'chain.forward([0.1 0.2])');
      [R, p] = c.at(c.posture(q, 'q'));
      X = [R p; 0 0 0 1];
    end

    function q = inverse(c, pose, q0)
    %INVERSE A posture within the limits that brings the tool to a pose, a 4 x 4 matrix as of forward, or only to a position
    %   [x y z] in m: the first found, starting at q0. Error if none is found. Damped least squares on the chain's Jacobian,
    %   restarted at random postures, the same on each call.
      coopdyn.internal.need(nargin, 2, 'chain.inverse(pose) or chain.inverse([0.3 0 0.5], q0)');
      if isnumeric(pose) && numel(pose) == 3
        R_T = [];
        p_T = [coopdyn.internal.number(pose(1), 'x [m]'); coopdyn.internal.number(pose(2), 'y [m]'); ...
               coopdyn.internal.number(pose(3), 'z [m]')];
      else
        pose = checked_pose(pose);
        R_T = pose(1:3, 1:3);
        p_T = pose(1:3, 4);
      end
      low = c.lower;
      low(isinf(low)) = min(-pi, c.upper(isinf(low)) - 1);
      high = c.upper;
      high(isinf(high)) = max(pi, low(isinf(high)) + 1);
      start = (low + high) / 2;
      if nargin > 2 && ~isempty(q0)
        start = c.posture(q0, 'q0');
      end
      nearest = Inf(6, 1);
      dice = 1;
      for k = 1:30
        [q, off] = c.descend(R_T, p_T, min(max(start, c.lower), c.upper));
        if norm(off) < 1e-7
          return
        end
        if norm(off) < norm(nearest)
          nearest = off;
        end
        for j = 1:numel(start)
          dice = mod(1664525 * dice + 1013904223, 4294967296);
          start(j) = low(j) + (high(j) - low(j)) * dice / 4294967296;
        end
      end
      angle = '';
      if ~isempty(R_T)
        angle = sprintf(' and %.3g rad', norm(nearest(4:6)));
      end
      coopdyn.internal.fail(4, sprintf(['no posture within the limits was found that brings the tool there: the nearest ' ...
        'is %.3g m%s off; choose a pose within reach, or give only a position [x y z]'], norm(nearest(1:3)), angle));
    end
  end
  methods (Access = private)
    function q = posture(c, q, what)
      if ~isnumeric(q) || numel(q) ~= numel(c.kinds)
        coopdyn.internal.fail(3, sprintf('%s has %d values, the chain %d joints', what, numel(q), numel(c.kinds)));
      end
      q = reshape(double(q), 1, []);
      if ~all(isfinite(q))
        coopdyn.internal.fail(4, ['the values of ' what ' must be finite']);
      end
    end

    function [R, p, J] = at(c, q)
    % Rotation and position of the tool, and the Jacobian of its position and rotation.
      n = numel(q);
      R = eye(3);
      t = zeros(3, 1);
      P = zeros(3, n);
      J = zeros(6, n);
      for i = 1:n
        axis = R * c.axes(:, i);
        P(:, i) = R * c.points(:, i) + t;
        if c.kinds(i) == 1
          J(1:3, i) = axis;
          t = t + axis * q(i);
        else
          J(4:6, i) = axis;
          a = c.axes(:, i);
          S = [0 -a(3) a(2); a(3) 0 -a(1); -a(2) a(1) 0];
          R = R * (eye(3) + sin(q(i)) * S + (1 - cos(q(i))) * (S * S));
          t = P(:, i) - R * c.points(:, i);
        end
      end
      p = R * c.tool(1:3, 4) + t;
      R = R * c.tool(1:3, 1:3);
      if nargout > 2
        d = p - P;
        hinge = c.kinds ~= 1;
        v = [J(5, :) .* d(3, :) - J(6, :) .* d(2, :); J(6, :) .* d(1, :) - J(4, :) .* d(3, :); ...
             J(4, :) .* d(2, :) - J(5, :) .* d(1, :)];
        J(1:3, hinge) = v(:, hinge);
      end
    end

    function [q, off] = descend(c, R_T, p_T, q)
    % Moves from q to a local minimum of the error `off`.
      for round = 1:100
        [R, p, J] = c.at(q);
        off = p_T - p;
        if ~isempty(R_T)
          off = [off; rotation_vector(R_T * R')]; %#ok<AGROW>
        end
        if norm(off) < 1e-10
          return
        end
        J = J(1:numel(off), :);
        slope = (J' * off)';
        J(:, (q >= c.upper & slope > 0) | (q <= c.lower & slope < 0)) = 0;  % freeze joints that would leave their limits
        step = (J' * ((J * J' + (off' * off / 2 + 1e-12) * eye(numel(off))) \ off))';
        longest = max([abs(step) 0]);
        if longest < 1e-14
          return
        end
        q = min(max(q + min(1, 0.7 / longest) * step, c.lower), c.upper);
      end
    end
  end
end

function v = rotation_vector(R)
% Axis times angle.
  v = [R(3, 2) - R(2, 3); R(1, 3) - R(3, 1); R(2, 1) - R(1, 2)] / 2;
  cosine = (trace(R) - 1) / 2;
  sine = norm(v);
  if sine > 1e-9
    v = v * (atan2(sine, cosine) / sine);
  elseif cosine < 0  % half a turn: a column of R + 1 is along the axis
    [~, k] = max(diag(R));
    v = R(:, k);
    v(k) = v(k) + 1;
    v = v * (pi / norm(v));
  end
end

function X = checked_pose(X)
  if ~isnumeric(X) || ~isequal(size(X), [4 4]) || ~isreal(X) || ~all(isfinite(X(:)))
    coopdyn.internal.fail(3, ['a pose is a 4 x 4 matrix, rotation and position [m] and the row 0 0 0 1 below, or a ' ...
                              'position [x y z], not ' coopdyn.internal.show(X)]);
  end
  R = X(1:3, 1:3);
  if norm(R * R' - eye(3)) > 1e-6 || det(R) < 0
    coopdyn.internal.fail(4, 'the upper left 3 x 3 of a pose is a rotation: its rows are at right angles and of length 1');
  end
  X = double(X);
end

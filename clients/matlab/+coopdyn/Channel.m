% SPDX-License-Identifier: MIT
classdef Channel < handle
%CHANNEL All motors and values that a robot's model maps (docs/yars.md), in one exchange. Made by r.channel().
%     c = r.channel();
%     {c.motors.name}, {c.values.name}
%     c.set([0.5 0.5]);                   % of all motors
%     c.set(0.2, 'left_motor');           % one of them, by its name or its number from 1; the others as they were set
%     sim.step(c.steps);                  % one exchange
%     c.get(), c.get('right_motor_velocity')
%   What is set goes with the next sim.step() in lockstep, and at once in real time. Rows are 1 x n.
  properties (SetAccess = private)
    motors     % a 1 x n struct: name, internal_min, internal_max: the range in the robot [SI units] that is external_min,
    values     % external_max here (Inf = not mapped), auxiliary: for the experimenter alone
    steps = 1  % of one exchange
  end
  properties (Access = private)
    session
    link
    told = []
  end
  methods
    function c = Channel(session, link)
      c.session = session;
      c.link = link;
      reply = session.read(link, link.actuator, 352, [], '');
      names = strsplit(strtrim(reply.text), ' ');
      rows = reshape(reply.data(1:6 * sum(reply.params(1:2))), 6, []);
      mapped = struct('name', {}, 'internal_min', {}, 'internal_max', {}, 'external_min', {}, 'external_max', {}, ...
                      'auxiliary', {});
      for k = 1:size(rows, 2)
        mapped(1, k) = struct('name', names{k}, 'internal_min', rows(1, k), 'internal_max', rows(2, k), ...
                              'external_min', rows(3, k), 'external_max', rows(4, k), 'auxiliary', rows(5, k) ~= 0);
      end
      c.motors = mapped(1:reply.params(1));
      c.values = mapped(reply.params(1) + 1:end);
      c.steps = double(reply.params(3));
    end

    function set(c, values, motors)
    %SET Sets motors, mapped: a value for each, or one for all. Motors that are not named stay as they were set.
      coopdyn.internal.need(nargin, 2, 'c.set([0.5 0.2]) or c.set(0.5, ''left_motor'')');
      if nargin < 3, motors = []; end
      n = numel(c.motors);
      ids = coopdyn.internal.chosen(motors, {c.motors.name}, 'motor', c.link.label);
      values = coopdyn.internal.spread(values, numel(ids), 'motor');
      if ~all(isfinite(values))
        coopdyn.internal.fail(4, ['values must be finite, not ' coopdyn.internal.show(values)]);
      end
      if numel(ids) < n && isempty(c.told)
        coopdyn.internal.fail(5, sprintf('set all %d motors first: c.set([...]), then one by its name', n));
      end
      now = c.told;
      now(ids) = values;
      c.link.command(c.session, 351, now, 1);  % for one step; then they stay
      c.told = now;
    end

    function v = get(c, values)
    %GET The values, mapped; of all that are called alike.
      if nargin < 2, values = []; end
      ids = coopdyn.internal.chosen(values, {c.values.name}, 'value', c.link.label);
      reply = c.session.read(c.link, c.link.actuator, 350, [], '');
      v = reply.data(ids);
    end

    function yes = aborted(c)
    %ABORTED True if the try is to end: a contact that the model says to end it is pressed.
      reply = c.session.read(c.link, c.link.actuator, 350, [], '');
      yes = strcmp(reply.text, 'aborted');
    end
  end
end

% SPDX-License-Identifier: MIT
classdef Channel < handle
%CHANNEL All motors and values that a robot's model maps (docs/yars.md), in one exchange. Made by r.channel().
%     c = r.channel();
%     {c.motors.name}, {c.values.name}
% all motors
% one motor, by its name or its number from 1; the others keep their values
%     sim.step(c.steps);                  % one exchange
%     c.get(), c.get('right_motor_velocity')
%   In lockstep, values are sent with the next sim.step(); in real time, immediately. Rows are 1 x n.
  properties (SetAccess = private)
    motors     % a 1 x n struct: name; internal_min, internal_max: range in the robot [SI units], mapped to external_min,
    values     % external_max here (Inf = not mapped); auxiliary: only for the experimenter
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
    %SET Sets motors in external units: one value for each, or one for all. Motors that are not named keep their values.
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
      c.link.command(c.session, 351, now, 1);  % for one step; the values then hold
      c.told = now;
    end

    function v = get(c, values)
    %GET Values in external units; a name returns all values of that name.
      if nargin < 2, values = []; end
      ids = coopdyn.internal.chosen(values, {c.values.name}, 'value', c.link.label);
      reply = c.session.read(c.link, c.link.actuator, 350, [], '');
      v = reply.data(ids);
    end

    function yes = aborted(c)
    %ABORTED True if the trial must end: a contact that the model declares as terminating is pressed.
      reply = c.session.read(c.link, c.link.actuator, 350, [], '');
      yes = strcmp(reply.text, 'aborted');
    end
  end
end

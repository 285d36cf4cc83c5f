% SPDX-License-Identifier: MIT
classdef Parts < handle
%PARTS Common base of coopdyn.Joints, Muscles and Thrusters, which are addressed by name or id.
  properties (SetAccess = private)
    name
    names  % of all parts; the first has id 1
  end
  properties (Access = protected)
    session
    link
    one    % their singular, e.g. 'joint'
  end
  methods
    function p = Parts(session, link, one, limits)
    % The reply to the command `limits` has their names.
      p.session = session;
      p.link = link;
      p.one = one;
      p.name = link.actuator;
      reply = session.read(link, link.actuator, limits, [], '');
      p.names = strsplit(strtrim(reply.text), ' ');
    end
  end
  methods (Access = protected)
    function ids = ids_of(p, parts)
      ids = coopdyn.internal.chosen(parts, p.names, p.one, p.link.label);
    end

    function command(p, number, values, parts)
      ids = p.ids_of(parts);
      values = coopdyn.internal.spread(values, numel(ids), p.one);
      if ~all(isfinite(values))
        coopdyn.internal.fail(4, ['values must be finite, not ' coopdyn.internal.show(values)]);
      end
      p.link.command(p.session, number, values, ids);
    end

    function v = reading(p, number, parts)
      params = [];
      if nargin > 2
        params = p.ids_of(parts);
      end
      reply = p.session.read(p.link, p.name, number, params, '');
      v = coopdyn.internal.value(number, reply.params, reply.text, reply.data(1:end - 2));
    end
  end
end

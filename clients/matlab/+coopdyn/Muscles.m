% SPDX-License-Identifier: MIT
classdef Muscles < coopdyn.internal.Parts
%MUSCLES The muscles of a robot. Made by r.muscles().
%     m = r.muscles();
%     m.set_activations(0.2);             % of all: the part of their force that they give, 0 to 1
%     m.set_activations(0.8, 'biceps');   % one muscle, by its name or its number from 1
%     sim.step();
%     m.get().force                       % N, of each
%   Commands go with the next sim.step() in lockstep, and at once in real time, as those of coopdyn.Joints. An activation stays
%   until the next. Rows are 1 x n.
  methods
    function m = Muscles(session, link)
      m = m@coopdyn.internal.Parts(session, link, 'muscle', 226);
      link.last = {224, zeros(1, numel(m.names))};
    end

    function set_activations(m, activations, muscles)
    %SET_ACTIVATIONS How much of their force muscles give, 0 to 1: a value for each, or one for all.
      coopdyn.internal.need(nargin, 2, 'm.set_activations([0.5 0.2]) or m.set_activations(0.5, ''biceps'')');
      if nargin < 3, muscles = []; end
      m.command(224, activations, muscles);
    end

    function v = get(m, varargin)
    %GET activation, force [N], length [m], velocity [m/s; positive grows longer], length_factor and velocity_factor, a struct
    %   of rows.
      v = m.reading(225, varargin{:});
    end

    function v = get_limits(m)
    %GET_LIMITS max_force [N], optimal_length [m] and max_velocity [m/s] of all muscles.
      v = m.reading(226);
    end
  end
end

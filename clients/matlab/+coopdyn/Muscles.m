% SPDX-License-Identifier: MIT
classdef Muscles < coopdyn.internal.Parts
%MUSCLES The muscles of a robot. Made by r.muscles().
%     m = r.muscles();
% all muscles: fraction of their force, 0 to 1
%     m.set_activations(0.8, 'biceps');   % one muscle, by its name or its number from 1
%     sim.step();
%     m.get().force                       % N, of each
%   In lockstep, commands are sent with the next sim.step(); in real time, immediately, as for coopdyn.Joints. An activation
%   holds until the next. Rows are 1 x n.
  methods
    function m = Muscles(session, link)
      m = m@coopdyn.internal.Parts(session, link, 'muscle', 226);
      link.last = {224, zeros(1, numel(m.names))};
    end

    function set_activations(m, activations, muscles)
    %SET_ACTIVATIONS Sets fractions of the muscles' force, 0 to 1: one value for each, or one for all.
      coopdyn.internal.need(nargin, 2, 'm.set_activations([0.5 0.2]) or m.set_activations(0.5, ''biceps'')');
      if nargin < 3, muscles = []; end
      m.command(224, activations, muscles);
    end

    function v = get(m, varargin)
    %GET activation, force [N], length [m], velocity [m/s; positive when lengthening], length_factor and velocity_factor, a
    %   struct of rows.
      v = m.reading(225, varargin{:});
    end

    function v = get_limits(m)
    %GET_LIMITS max_force [N], optimal_length [m] and max_velocity [m/s] of all muscles.
      v = m.reading(226);
    end
  end
end

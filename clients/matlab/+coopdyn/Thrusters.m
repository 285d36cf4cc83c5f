% SPDX-License-Identifier: MIT
classdef Thrusters < coopdyn.internal.Parts
%THRUSTERS The thrusters of a robot. Made by r.thrusters().
%     t = r.thrusters();
% N; N m for thrusters that turn their link
%     t.set_thrusts(0, 'jet');            % one thruster, by its name or its number from 1
%   In lockstep, commands are sent with the next sim.step(); in real time, immediately, as for coopdyn.Joints. A thrust holds
%   until the next. Rows are 1 x n.
  methods
    function t = Thrusters(session, link)
      t = t@coopdyn.internal.Parts(session, link, 'thruster', 229);
      link.last = {227, zeros(1, numel(t.names))};
    end

    function set_thrusts(t, thrusts, thrusters)
    %SET_THRUSTS Forces [N] and torques [N m] of thrusters: a value for each, or one for all.
      coopdyn.internal.need(nargin, 2, 't.set_thrusts([2 0.1]) or t.set_thrusts(2, ''jet'')');
      if nargin < 3, thrusters = []; end
      t.command(227, thrusts, thrusters);
    end

    function v = get(t, varargin)
    %GET thrust [N, N m], and velocity of the link along or about the thrust direction [m/s, rad/s], a struct of rows.
      v = t.reading(228, varargin{:});
    end

    function v = get_limits(t)
    %GET_LIMITS max_thrust [N, N m] of all thrusters.
      v = t.reading(229);
    end
  end
end

% SPDX-License-Identifier: MIT
function names = robot_names(session)
%ROBOT_NAMES The names of all robots, in the order of the scenario.
  names = {};
  while true  % one status lists only a part of them
    reply = session.control(100, [numel(names) + 1, 1000]);
    s = jsondecode(reply.text);
    if isempty(s.robots)
      return
    end
    names = [names reshape({s.robots.name}, 1, [])]; %#ok<AGROW>
    if ~isfield(s, 'robot_count') || numel(names) >= s.robot_count
      return
    end
  end
end

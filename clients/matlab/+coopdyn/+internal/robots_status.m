% SPDX-License-Identifier: MIT
function robots = robots_status(session)
%ROBOTS_STATUS The status of all robots, a cell array of structs in the order of the scenario.
  robots = {};
  while true  % one status lists only some of them
    reply = session.control(100, [numel(robots) + 1, 1000]);
    s = jsondecode(reply.text);
    if isempty(s.robots)
      return
    end
    robots = [robots reshape(num2cell(s.robots), 1, [])]; %#ok<AGROW>
    if ~isfield(s, 'robot_count') || numel(robots) >= s.robot_count
      return
    end
  end
end

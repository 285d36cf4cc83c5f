% SPDX-License-Identifier: MIT
function names = robot_names(session)
%ROBOT_NAMES The names of all robots, in the order of the scenario.
  names = cellfun(@(r) r.name, coopdyn.internal.robots_status(session), 'UniformOutput', false);
end

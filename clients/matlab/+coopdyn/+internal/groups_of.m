% SPDX-License-Identifier: MIT
function groups = groups_of(session, robot)
%GROUPS_OF The names of a robot's groups of joints, in the robot's order.
  [names, types] = coopdyn.internal.actuators_of(session, robot);
  groups = names(strcmp(types, 'joints'));
end

% SPDX-License-Identifier: MIT
function link = group(session, first, name)
%GROUP The link to a group of joints of the robot with this first link; '': the only one.
  session.require_open();
  first.require_here();
  groups = coopdyn.internal.groups_of(session, first.robot);
  if isempty(groups)
    coopdyn.internal.fail(5, [first.robot ' has no joints with motors of their own']);
  end
  there = ['there are: ' coopdyn.internal.list_of(groups)];
  if isempty(name)
    if numel(groups) > 1
      coopdyn.internal.fail(5, [first.robot ' has several groups of joints; write r.joints(''' groups{1} '''); ' there]);
    end
    name = groups{1};
  end
  links = [{first} first.others];
  at = find(cellfun(@(link) strcmp(link.actuator, name), links) & any(strcmp(groups, name)), 1);
  if isempty(at)
    coopdyn.internal.fail(10, [first.robot ' has no joints ''' name '''; ' coopdyn.internal.nearest(name, groups) there]);
  end
  link = links{at};
end

% SPDX-License-Identifier: MIT
function link = take_robot(session, robot)
%TAKE_ROBOT The link to a robot, opened and (unless watching) claimed.
  session.require_open();
  in_team = session.has_team_with(robot);
  keep = true(1, numel(session.links));
  for k = 1:numel(session.links)
    link = session.links{k};
    if strcmp(link.robot, robot)
      if isempty(link.lost) && link.in_team == in_team
        return
      end
      keep(k) = false;
    end
  end
  link = coopdyn.internal.Link(session.address, robot, ~session.watch);
  if in_team
    link.in_team = true;
    link.motors = [];
    session.links = [session.links(keep) {link}];
    return
  end
  try
    link.open(session);
  catch cause
    if ~strcmp(cause.identifier, 'coopdyn:no_such_name')
      rethrow(cause);
    end
    robots = coopdyn.internal.robot_names(session);
    if ~any(strcmp(robots, robot))
      coopdyn.internal.fail(10, ['there is no robot ''' robot '''; ' coopdyn.internal.nearest(robot, robots) ...
        'there are: ' coopdyn.internal.list_of(robots)]);
    end
    if link.find_again(session, 'motors', link.motors)
      link.open(session);
    else
      link.motors = [];  % it has no motors: it can be read only
    end
  end
  session.links = [session.links(keep) {link}];
end

% SPDX-License-Identifier: MIT
function link = take_robot(session, robot)
%TAKE_ROBOT The link to a robot, opened and (unless watching) claimed, with all its actuators.
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
  link.in_team = in_team;
  if in_team
    link.motors = [];
  else
    open_motors(session, link);
  end
  [names, types] = coopdyn.internal.actuators_of(session, robot);
  try
    for k = find(~ismember(types, {'motors', 'channel'}))
      if isempty(link.motors) && ~in_team
        link.drive_part(session.address, names{k}, types{k}, ~session.watch);
        link.open(session);
        continue
      end
      other = coopdyn.internal.Link(session.address, robot, ~session.watch);
      other.in_team = in_team;
      other.drive_part(session.address, names{k}, types{k}, ~session.watch);
      link.others{end + 1} = other;
      if in_team
        other.motors = [];
      else
        other.open(session);
      end
    end
  catch cause
    link.close();
    for k = 1:numel(link.others)
      other = link.others{k};
      other.close();
    end
    rethrow(cause);
  end
  session.links = [session.links(keep) {link} link.others];
end

function open_motors(session, link)
% Without motors link.motors is [] afterwards.
  try
    link.open(session);
  catch cause
    if ~strcmp(cause.identifier, 'coopdyn:no_such_name')
      rethrow(cause);
    end
    robots = coopdyn.internal.robot_names(session);
    if ~any(strcmp(robots, link.robot))
      coopdyn.internal.fail(10, ['there is no robot ''' link.robot '''; ' coopdyn.internal.nearest(link.robot, robots) ...
        'there are: ' coopdyn.internal.list_of(robots)]);
    end
    if link.find_again(session, 'motors', link.motors)
      link.open(session);
    else
      link.motors = [];
    end
  end
end

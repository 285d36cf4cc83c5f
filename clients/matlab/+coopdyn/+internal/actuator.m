% SPDX-License-Identifier: MIT
function link = actuator(session, first, type)
%ACTUATOR The link to the muscles, thrusters or channel of the robot with this first link. For a channel, gives up the
%  robot's other actuators, which the channel then drives.
  session.require_open();
  first.require_here();
  links = [{first} first.others];
  at = find(cellfun(@(link) strcmp(link.type, type), links), 1);
  if ~isempty(at)
    link = links{at};
    return
  end
  [names, types] = coopdyn.internal.actuators_of(session, first.robot);
  at = find(strcmp(types, type), 1);
  if isempty(at) || ~strcmp(type, 'channel')
    coopdyn.internal.fail(5, [first.robot ' has no ' type '; its actuators: ' coopdyn.internal.list_of(names)]);
  end
  link = coopdyn.internal.Link(session.address, first.robot, ~session.watch);
  link.in_team = first.in_team;
  link.drive_part(session.address, names{at}, type, ~session.watch);
  if first.in_team
    link.motors = [];
  else
    for k = 1:numel(links)
      give_to_channel(session, links{k});
    end
    link.open(session);
  end
  first.others{end + 1} = link;
  session.links{end + 1} = link;
end

function give_to_channel(session, link)
  if ~isempty(link.motors)
    link.settle(session);
    if ~session.watch && ~link.unclaimed
      link.motors.request(8, [], []);
    end
    link.motors.close();
  end
  link.motors = [];
  link.drives = false;
  link.forget_commands();
  link.by_channel = true;
end

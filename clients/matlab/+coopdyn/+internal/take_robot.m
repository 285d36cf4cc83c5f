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
    modules = coopdyn.internal.ask_names(session.address);
    names = {modules.name};
    if ~any(strncmp(names, ['/' robot '/'], numel(robot) + 2))
      found = regexp(names, '^/([^/]+)/', 'tokens', 'once');
      robots = unique(cellfun(@(t) t{1}, found(~cellfun(@isempty, found)), 'UniformOutput', false));
      coopdyn.internal.fail(10, ['there is no robot ''' robot '''; ' coopdyn.internal.nearest(robot, robots) ...
        'there are: ' coopdyn.internal.list_of(robots)]);
    end
    link.motors = [];  % it has no motors: it can be read only
  end
  session.links = [session.links(keep) {link}];
end

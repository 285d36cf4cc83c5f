% SPDX-License-Identifier: MIT
function loaded(session)
%LOADED After a load of ours: teams begin anew, and robots that are not there any more are lost.
  session.started_anew();
  for k = 1:numel(session.teams)
    team = session.teams{k};  % opened again with the robots that there are now
    team.connection.close();
    team.names = {};
  end
  names = coopdyn.internal.robot_names(session);
  keep = true(1, numel(session.links));
  for k = 1:numel(session.links)
    link = session.links{k};
    if ~any(strcmp(names, link.robot))
      link.lost = ['the scenario that was loaded has no ' link.robot '; there are: ' coopdyn.internal.list_of(names)];
      link.lost_code = 10;
      link.close();
      keep(k) = false;
    end
  end
  session.links = session.links(keep);
end

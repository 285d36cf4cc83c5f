% SPDX-License-Identifier: MIT
function gone = loaded(session)
%LOADED After a load: makes teams reopen, and marks robots that the new scenario lacks as lost. Returns their names.
  session.started_anew();
  session.note_scenario();
  for k = 1:numel(session.teams)
    team = session.teams{k};  % reopens with the present robots
    team.connection.close();
    team.names = {};
    if team.lost_code == 5  % it had no robots left
      team.lost = '';
    end
  end
  names = coopdyn.internal.robot_names(session);
  keep = true(1, numel(session.links));
  gone = {};
  for k = 1:numel(session.links)
    link = session.links{k};
    if ~any(strcmp(names, link.robot))
      link.lost = ['the scenario that was loaded has no ' link.robot '; there are: ' coopdyn.internal.list_of(names)];
      link.lost_code = 10;
      link.close();
      keep(k) = false;
      gone{end + 1} = link.robot; %#ok<AGROW>
    end
  end
  gone = unique(gone, 'stable');
  session.links = session.links(keep);
  for k = 1:numel(session.links)
    link = session.links{k};
    link.modules = struct();
  end
end

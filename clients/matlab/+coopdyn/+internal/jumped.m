% SPDX-License-Identifier: MIT
function jumped(session)
%JUMPED After a restore or branch of ours: the world goes on from another state, maybe of another scenario.
  session.started_anew();
  session.control(3);  % tells the mode
  driven = {};
  for group = {session.links, session.teams}
    for k = 1:numel(group{1})
      driven = [driven group{1}{k}.names]; %#ok<AGROW>
    end
  end
  if ~isempty(driven) && ~all(ismember(driven, coopdyn.internal.robot_names(session)))
    coopdyn.internal.loaded(session);
  end
end

% SPDX-License-Identifier: MIT
function [names, ids] = find_team(session, connection, text)
%FIND_TEAM The robots that the names of a team mean in a recording that is played, where claim tells no ids.
  there = coopdyn.internal.robot_names(session);
  known = known_ids(connection, numel(there));
  there = there(1:numel(known));
  meant = true(1, numel(there));
  words = strsplit(strtrim(text), ' ');
  if ~isempty(words{1})
    swarm = regexprep(there, '_\d+$', '');
    in_swarm = ~strcmp(swarm, there);
    swarms = unique(swarm(in_swarm));
    if numel(swarms) == 1 && ~all(ismember(words, [there swarms]))
      words = [words swarms];  % the section, swarm1, of the only swarm
    end
    meant = ismember(there, words) | in_swarm & ismember(swarm, words);
    if ~any(meant)
      coopdyn.internal.fail(10, ['none of ' coopdyn.internal.list_of(words) ' is there at this moment of the ' ...
        'recording under that name, write the NAME of a swarm or robots; there are: ' coopdyn.internal.list_of(there)]);
    end
  end
  names = there(meant);
  ids = known(meant);
  for k = 1:numel(session.links)  % after a branch the team drives these
    link = session.links{k};
    if link.unclaimed && ~isempty(link.motors) && any(strcmp(names, link.robot))
      link.in_team = true;
      link.motors.close();
      link.motors = [];
    end
  end
end

function ids = known_ids(connection, n)
% The ids of the n robots, in their order: from 1 on, with gaps where robots have been removed.
  ids = 1:n;
  if n == 0 || are_there(connection, ids)
    return
  end
  ids = zeros(1, 0);
  id = 1;
  while numel(ids) < n && id <= n + 100000
    if are_there(connection, id)
      ids(end + 1) = id; %#ok<AGROW>
    end
    id = id + 1;
  end
end

function yes = are_there(connection, ids)
  yes = true;
  try
    connection.request(112, ids, []);
  catch cause
    if ~strcmp(cause.identifier, 'coopdyn:no_such_name')
      rethrow(cause);
    end
    yes = false;
  end
end

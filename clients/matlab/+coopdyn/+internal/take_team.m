% SPDX-License-Identifier: MIT
function team = take_team(session, text)
%TAKE_TEAM The team of these names, opened and claimed.
  session.require_open();
  if session.watch
    coopdyn.internal.fail(5, 'this sim only watches; connect without ''watch'' to drive a team');
  end
  session.drop_lost_teams();
  numbers = zeros(1, 0);
  for k = 1:numel(session.teams)
    team = session.teams{k};
    if strcmp(team.text, text)
      try
        team.settle(session);  % updates its members
        return
      catch cause
        if isempty(team.lost)
          rethrow(cause);
        end
      end
    end
    numbers(end + 1) = team.number; %#ok<AGROW>
  end
  session.drop_lost_teams();
  for k = 1:numel(session.teams)  % robots that one of our teams lost only for a moment are not free
    other = session.teams{k};
    if ~isempty(other.names) && ~other.connection.idle
      try
        other.settle(session);
      catch
        % its next use reports the error
      end
    end
  end
  team = coopdyn.internal.TeamLink(session.address, text, min(setdiff(1:numel(numbers) + 1, numbers)));
  try
    team.open(session);
  catch cause
    if strcmp(cause.identifier, 'coopdyn:owned')
      robot = strtok(cause.message, ' ');
      if session.let_go(robot)
        team = coopdyn.internal.take_team(session, text);
        return
      end
      for k = 1:numel(session.teams)
        other = session.teams{k};
        if isempty(other.lost) && any(strcmp(other.names, robot))
          coopdyn.internal.fail(6, ['robot ' robot ' belongs to your ' other.label ': drive it there, or release ' ...
            'that team first']);
        end
      end
      label = ['the team with ' robot];
      if team.one_word()
        label = team.label;
      end
      coopdyn.internal.fail(6, [label ' cannot be driven: ' cause.message]);
    end
    rethrow(cause);
  end
  session.teams{end + 1} = team;
end

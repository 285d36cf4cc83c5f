% SPDX-License-Identifier: MIT
function recover(session, connections, links, cause)
%RECOVER Connections that still wait for a reply are closed and opened again: reading on would take the next reply for the
%  one that is missing. Raises the cause.
  raised = cause;
  again = {};
  for k = 1:numel(connections)
    c = connections{k};
    link = links{k};
    if c.idle
      continue  % it has had its reply, or nothing was sent
    end
    gone = isempty(c.socket);
    c.close();
    if isempty(link)
      continue
    end
    link.forget_commands();
    if gone && strcmp(cause.identifier, 'coopdyn:connection')
      try
        coopdyn.internal.lose(session, link, cause);
      catch raised
      end
    end
    again{end + 1} = link; %#ok<AGROW>
  end
  for k = 1:numel(again)
    link = again{k};
    if isempty(link.lost)
      try
        link.open(session);
      catch
        % tried again at the next use, which says what is wrong
      end
    end
  end
  if any(strcmp(raised.message, {'reset', 'load'})) && strcmp(raised.identifier, 'coopdyn:reset')
    session.new_world(raised.message);
  end
  if any(cellfun(@(t) t.stale, session.teams))
    session.raise_if_loaded(raised);
  end
  for k = 1:numel(session.teams)
    team = session.teams{k};
    if team.stale && isempty(team.lost)
      try
        team.settle(session);
      catch another
        if ~isempty(team.lost)
          raised = another;  % otherwise its next use says what is wrong
        end
      end
    end
  end
  rethrow(raised);
end

% SPDX-License-Identifier: MIT
function recover(session, connections, links, cause)
%RECOVER Closes and reopens connections whose reply is pending: otherwise the late reply would be mistaken for the next one.
%  Raises the cause.
  raised = cause;
  again = {};
  for k = 1:numel(connections)
    c = connections{k};
    link = links{k};
    if c.idle
      continue  % its reply has arrived, or nothing was sent
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
        % the next use tries again, and reports the error
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
          raised = another;  % otherwise its next use reports the error
        end
      end
    end
  end
  rethrow(raised);
end

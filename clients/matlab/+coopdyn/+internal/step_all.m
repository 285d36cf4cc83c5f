% SPDX-License-Identifier: MIT
function step_all(s, n, limit, commanded, bytes)
%STEP_ALL A step of the world with every robot and every team of session s, as Session.step says.
  s.require_open();
  connections = {};
  links = {};
  for k = 1:numel(s.links)
    link = s.links{k};
    link.unstepped = 0;
  end
  if ~s.watch
    settled = {};
    for k = 1:numel(s.teams)
      team = s.teams{k};
      try
        team.settle(s);
        settled{end + 1} = team; %#ok<AGROW>
      catch cause
        if (isempty(team.lost) && ~isempty(team.names)) || nargin > 3 && team.number == commanded.number
          rethrow(cause);
        end
      end  % else the others go on without one that is lost, or whose robots are another's after a load
    end
    s.drop_lost_teams();
    for k = 1:numel(s.links)
      link = s.links{k};
      c = link.motors;
      if link.drives && isempty(link.sent) && ~c.busy && ~isempty(c.socket) || link.takes_part(s)
        links{end + 1} = link; %#ok<AGROW>
        connections{end + 1} = c; %#ok<AGROW>
      end
    end
    for k = 1:numel(settled)
      links{end + 1} = settled{k}; %#ok<AGROW>
      connections{end + 1} = settled{k}.connection; %#ok<AGROW>
    end
  end
  if isempty(links)
    links = {[]};
    connections = {s.connection('/simulation')};
  end
  since = s.reached + 1;
  try
    for k = 1:numel(links)
      link = links{k};
      c = connections{k};
      if isempty(link)
        c.send(2, coopdyn.internal.encode(2, n, []));
      elseif nargin > 3 && link.is_team && link.number == commanded.number
        c.send(110, bytes);
      else
        [number, frame] = link.frame(n);
        c.send(number, frame);
      end
    end
    earliest = coopdyn.internal.collect(s, connections, links, limit);
  catch cause
    coopdyn.internal.recover(s, connections, links, cause);
  end
  s.go_on(earliest, since);
end

% SPDX-License-Identifier: MIT
function step_all(s, n, limit, commanded, bytes)
%STEP_ALL Runs a step of the world with every robot and team of session s; see Session.step.
  s.require_open();
  connections = {};
  links = {};
  if ~s.watch
    settled = {};
    teams = s.teams;
    for k = 1:numel(teams)
      team = teams{k};
      try
        team.settle(s);
        settled{end + 1} = team; %#ok<AGROW>
      catch cause
        if (isempty(team.lost) && ~isempty(team.names)) || nargin > 3 && team.number == commanded.number
          rethrow(cause);
        end
      end  % else other teams continue without a lost one, or one whose robots another client got after a load
    end
    if ~isempty(teams)
      s.drop_lost_teams();
    end
    driven = s.links;
    beside = {};
    for k = 1:numel(driven)
      link = driven{k};
      c = link.motors;
      if link.beside
        beside{end + 1} = link; %#ok<AGROW>
      elseif link.drives && isempty(link.sent) && c.idle || link.takes_part(s)
        links{end + 1} = link; %#ok<AGROW>
        connections{end + 1} = c; %#ok<AGROW>
      end
    end
    others = ~isempty(links) || ~isempty(settled);
    for k = 1:numel(beside)
      link = beside{k};
      if (others && ~link.is_free(s)) || ~link.takes_part(s)
        continue
      end
      link.beside = others;  % without others, this robot makes the step
      if ~others
        links{end + 1} = link; %#ok<AGROW>
        connections{end + 1} = link.motors; %#ok<AGROW>
      elseif ~isempty(link.kept)
        link.send_step(s);
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
  count = numel(links);
  numbers = zeros(1, count);
  try
    for k = 1:count
      link = links{k};
      if isempty(link)
        number = 2;
        frame = coopdyn.internal.encode(2, n, []);
      elseif nargin > 3 && link.is_team && link.number == commanded.number
        number = 110;
        frame = bytes;
      else
        [number, frame] = link.frame(n);
      end
      connections{k}.send(number, frame);
      numbers(k) = number;
    end
    % The last request triggers the step: most often the replies arrive at once.
    earliest = Inf;
    come = 0;
    while come < count && ~isempty(links{come + 1})
      reply = connections{come + 1}.answer(numbers(come + 1));
      if isempty(reply)
        break
      end
      come = come + 1;
      earliest = min(earliest, links{come}.stepped(s, reply));
    end
    if come < count
      earliest = min(earliest, coopdyn.internal.collect(s, connections, links, limit, come));
    end
  catch cause
    coopdyn.internal.recover(s, connections, links, cause);
  end
  s.go_on(earliest, since);
end

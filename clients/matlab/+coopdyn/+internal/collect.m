% SPDX-License-Identifier: MIT
function earliest = collect(s, connections, links, limit, come)
%COLLECT Collects the replies of all connections but the first `come`, which have theirs; returns the earliest step of the
%   replies. Raises the first error.
  if nargin < 5
    come = 0;
  end
  earliest = Inf;
  waiting = come + 1:numel(connections);
  stepped = 1:come;
  stepped_s = Inf;
  if come > 0 || any(cellfun(@(link) link.beside, s.links))  % one may be a participant by now
    stepped_s = 0;
  end
  wait = [];
  patient = true;  % the next poll may wait a little: one such poll per round
  while true
    left = [];
    for k = waiting
      reply = connections{k}.poll(patient);
      if isempty(reply)
        patient = false;
        left(end + 1) = k; %#ok<AGROW>
        continue
      end
      link = links{k};
      if isempty(link)
        coopdyn.internal.check_reply(reply, '');
        s.note(reply);
        step = reply.data(end);
      else
        step = link.stepped(s, reply);
      end
      earliest = min(earliest, step);
      stepped(end + 1) = k; %#ok<AGROW>
      stepped_s = 0;
      if ~isempty(wait)
        stepped_s = wait.now_s;
      end
    end
    waiting = left;
    if isempty(waiting)
      return
    end
    if isempty(wait)
      wait = coopdyn.internal.Wait(s, limit, 'the step did not run', false, ~isempty(links{1}));
    end
    wait.rest();
    patient = wait.patient;
    if wait.now_s - stepped_s > 0.1
      stepped_s = wait.now_s;
      [connections, links, waiting, behind] = catch_up(s, connections, links, stepped, waiting);
      stepped = setdiff(stepped, behind);
      waiting = [waiting behind]; %#ok<AGROW>
      if isempty(waiting)
        earliest = min(earliest, s.newest(2));
        return
      end
    end
  end
end

function [connections, links, waiting, again] = catch_up(s, connections, links, stepped, waiting)
% Resolves a deadlock: after an error or timeout, an old command may still run while its successor is on the way. Its robot
% is then one step behind the others, and both would wait for each other forever. If the status says that the world waits
% for robots of ours that have stepped already, steps these once more with their present commands. If it also waits for a
% robot whose reply is pending, that reply will arrive: does nothing. Sets robots that are no participants (among the first
% that the status lists) beside, because their commands may have arrived after the others' step and then run in the next.
  again = [];
  status = coopdyn.internal.fresh_status(s.address);
  if isempty(status.awaiting)
    return
  end
  awaited = {status.awaiting.robot};
  before = s.reached;
  joining = s.links(cellfun(@(link) link.beside && link.is_free(s) && is_among(link, awaited), s.links));
  has_stepped = ~isempty(stepped) || s.reached > before;
  if has_stepped
    set_beside(s, status.robots);
    waiting = waiting(cellfun(@(link) isempty(link) || link.is_team || ~link.beside || isempty(link.sent), links(waiting)));
  end
  for k = 1:numel(joining)
    link = joining{k};
    link.beside = false;
    if ~has_stepped
      links{end + 1} = link; %#ok<AGROW>
      connections{end + 1} = link.motors; %#ok<AGROW>
      waiting(end + 1) = numel(links); %#ok<AGROW>
      link.send_step(s);
    end
  end
  if isempty(waiting)
    return
  end
  for j = waiting
    if ~isempty(links{j}) && is_among(links{j}, awaited)
      return
    end
  end
  n = 0;
  for j = stepped
    if ~isempty(links{j})
      n = n + numel(links{j}.names);
    end
  end
  if isfield(status, 'awaiting_count') && status.awaiting_count > max(n, numel(awaited))  % not all are listed
    return
  end
  for j = stepped
    link = links{j};
    if isempty(link) || ~is_among(link, awaited)
      continue
    end
    number = 2;
    steps = 1;
    if link.is_team
      number = 110;
      steps = [];
    end
    c = connections{j};
    c.send(number, coopdyn.internal.encode(number, steps, []));
    again(end + 1) = j; %#ok<AGROW>
  end
end

function set_beside(s, robots)
  if ~iscell(robots)
    robots = num2cell(robots);
  end
  robots = robots(cellfun(@(robot) isfield(robot, 'participates') && ~robot.participates, robots));
  names = cellfun(@(robot) robot.name, robots, 'UniformOutput', false);
  for k = 1:numel(s.links)
    link = s.links{k};
    if ~link.beside && ~isempty(link.motors) && ismember(link.robot, names)
      link.beside = true;
      link.sent_at = s.reached;
    end
  end
end

function yes = is_among(link, awaited)
% For a robot with several actuators the status names ROBOT/MODULE; its channel drives them all.
  robots = strtok(awaited, '/');
  yes = ismember(robots, link.names);
  if ~link.is_team && ~strcmp(link.type, 'channel')
    yes = yes & ismember(awaited, {link.robot, [link.robot '/' link.actuator]});
  end
  yes = any(yes);
end

% SPDX-License-Identifier: MIT
classdef TeamLink < handle
%TEAMLINK A team as this client drives it: one connection to /swarm, which owns all its robots.
  properties
    text                          % the names as they were asked for
    number                        % tells the teams of one sim apart
    connection
    is_team = true
    selected = 'pose distances'
    neighbours = 8
    names = {}
    ids = zeros(1, 0)
    readings = {}                 % in the order of a row
    columns = zeros(1, 0)         % of each
    stale = false                 % who is in it must be asked again
    reply = []                    % to the step that ran last
    gone = {}                     % who was taken from it since it stepped last
    lost = ''                     % why it is not ours any more
    playing = ''                  % a recording is played, so the team can only be read: the text of the error
    lost_code = 6
  end
  properties (Dependent)
    label                         % in errors
  end
  methods
    function label = get.label(t)
      label = sprintf('team of %d robots', numel(t.names));
      if t.one_word()
        label = ['team ' t.text];
      end
    end

    function yes = one_word(t)
      yes = ~isempty(t.text) && ~any(t.text == ' ');
    end

    function t = TeamLink(address, text, number)
      t.text = text;
      t.number = number;
      t.connection = coopdyn.internal.Connection(address, '/swarm', true, number);
    end

    function open(t, session)
    % Opens (again): hello takes over from an older connection of this client, claim makes the robots ours.
      c = t.connection;
      c.open();
      try
        if isempty(t.names)
          c.request(8, [], []);  % an older team may have been of others
        end
        t.take(session);
        if isempty(t.names)
          coopdyn.internal.fail(10, ['no robot is free: other programs, loaded controllers or other objects ' ...
            'of this program drive them all. What a scenario''s controller drives is free without it: ' ...
            'launch(..., ''set'', {''SWARM_1.controller'', ''''})']);
        end
        t.choose(t.selected, t.neighbours);
        session.note(c.request(3, [], []));
      catch cause
        c.close();
        rethrow(cause);
      end
    end

    function settle(t, session)
    % Makes the connection free for a request.
      if session.closed || ~isempty(t.lost)
        session.require_open();
        coopdyn.internal.fail(t.lost_code, t.lost);
      end
      c = t.connection;
      if ~c.idle  % never opened again, or interrupted
        t.open(session);
      elseif t.stale
        if isempty(t.playing)
          t.named(c.request(113, [], []), session);
        else
          t.take(session);
        end
      end
    end

    function take(t, session)
    % Makes the robots ours; while a recording is played only finds out which they are.
      text = '';
      try
        reply = t.claim(session);
        if isempty(reply.params)
          status = session.brief_status();
          if isfield(status, 'playback') && ~isempty(status.playback)
            text = 'playing a recording: sim.branch() goes on live from here';
          end
        end
      catch cause
        if ~coopdyn.internal.is_playing(cause)
          rethrow(cause);
        end
        text = cause.message;
      end
      if isempty(text)
        t.playing = '';
        t.named(reply, session);
        return
      end
      [t.names, t.ids] = find_team(session, t.connection, t.text);
      t.stale = false;
      t.playing = text;
    end

    function own(t, session)
    % An error while a recording is played; a branch may have gone on live from there.
      t.settle(session);
      if ~isempty(t.playing)
        t.take(session);
      end
      if ~isempty(t.playing)
        coopdyn.internal.fail(5, t.playing);
      end
    end

    function reply = read(t, session)
    % The readings of the newest step.
      t.settle(session);
      if isempty(t.playing)
        reply = t.ask(session, 112);
        return
      end
      try
        reply = t.ask(session, 112, t.ids);
      catch cause
        if ~strcmp(cause.identifier, 'coopdyn:no_such_name')
          rethrow(cause);
        end
        [t.names, t.ids] = find_team(session, t.connection, t.text);  % at this moment there are others
        reply = t.ask(session, 112, t.ids);
      end
      t.choose(t.selected, t.neighbours);
      % Of robots that are not ours the daemon does not tell there how many distances they have.
      at = strcmp(t.readings, 'distances');
      t.columns(at) = t.columns(at) + reply.params(end) - sum(t.columns);
    end

    function reply = ask(t, session, command, params)
    % A request that is answered at once.
      if nargin < 4, params = []; end
      t.settle(session);
      since = session.reached;
      try
        reply = t.connection.request(command, params, []);
      catch cause
        if ~strcmp(cause.identifier, 'coopdyn:connection')
          session.raise_if_loaded(cause);
        end
        coopdyn.internal.lose(session, t, cause);
      end
      session.note(reply);
      session.go_on(reply.data(end), since);
    end

    function choose(t, words, neighbours)
      params = [];
      if ~isempty(strfind(words, 'neighbours'))
        params = neighbours;
      end
      reply = t.connection.request(111, params, [], words);
      t.selected = words;
      t.neighbours = neighbours;
      t.readings = strsplit(strtrim(reply.text), ' ');
      t.columns = reply.params;
    end

    function reply = claim(t, session)
    % Claims again the robots that it had, except those that another team has by now. Its name may mean others today.
      c = t.connection;
      wanted = t.names;
      for k = 1:numel(session.teams)
        other = session.teams{k};
        if other.number ~= t.number && isempty(other.lost)
          wanted = wanted(~ismember(wanted, other.names));
        end
      end
      while ~isempty(wanted)
        try
          reply = c.request(7, [], [], strjoin(wanted, ' '));
          return
        catch cause
          if strcmp(cause.identifier, 'coopdyn:no_such_name')
            break  % another world
          end
          taken = strcmp(wanted, strtok(cause.message, ' '));
          if ~strcmp(cause.identifier, 'coopdyn:owned') || ~any(taken)
            rethrow(cause);
          end
          wanted = wanted(~taken);
        end
      end
      if ~isempty(t.names) && isempty(wanted)
        reply = c.request(113, [], []);  % none is left
        return
      end
      reply = c.request(7, [], [], t.text);
    end

    function named(t, reply, session)
    % Notes who is in the team. A team that has lost all its robots is lost itself.
      before = t.names;
      t.stale = false;
      t.ids = reply.params;
      t.names = {};
      if ~isempty(strtrim(reply.text))
        t.names = strsplit(strtrim(reply.text), ' ');
      end
      if numel(t.names) < numel(before)
        t.gone = [t.gone, before(~ismember(before, t.names))];
      end
      if ~isempty(before) && isempty(t.names)
        what = sprintf('the team of %d robots', numel(before));
        if t.one_word()
          what = t.label;
        end
        t.lost = [what ' has lost all its robots, to other programs or another scenario: ' t.take_again() ...
          ' takes those that it names now'];
        t.lost_code = 5;
        t.connection.close();
        session.raise_if_loaded(struct('identifier', ''));
        coopdyn.internal.fail(5, t.lost);
      end
    end

    function [number, bytes] = frame(t, n) %#ok<INUSL>
    % The request that makes n steps with the speeds that it has: ready.
      number = 2;
      bytes = typecast(int32([24 0 2 0 1 0 n]), 'uint8');
    end

    function step = stepped(t, session, reply)
    % Takes in the reply to a step; the step that it tells.
      if reply.error ~= 0
        t.stale = true;  % a robot may have been taken from it
        coopdyn.internal.check_reply(reply, [t.label ': ']);
      end
      newest = reply.data(end - 1:end);
      step = newest(2);
      session.newest = newest;
      session.mode = reply.params(1);
      t.reply = reply;
    end

    function refresh(t, session)
    % What of a row changes if robots or targets have come or gone.
      t.named(t.ask(session, 113), session);
      t.choose(t.selected, t.neighbours);
    end

    function text = take_again(t)
      text = 'sim.team()';
      if ~isempty(t.text) && ~t.one_word()
        text = 'sim.team({...})';
      elseif ~isempty(t.text)
        text = ['sim.team(''' t.text ''')'];
      end
    end

    function give_up(t, stop)
    % Gives the robots up, after stopping them if wished.
      c = t.connection;
      if isempty(t.lost) && ~isempty(c.socket)
        try
          if c.idle && stop  % else interrupted: closing ends what waits
            c.request(114, [], [], '', 1);
          end
          if c.idle
            c.request(8, [], [], '', 1);
          end
        catch
          % it is gone already
        end
      end
      c.close();
      if isempty(t.lost)
        t.lost = [t.label ' was given up; ' t.take_again() ' takes it again'];
        t.lost_code = 5;
      end
    end

    function forget_commands(t)
      t.reply = [];
    end
  end
end

function [names, ids] = find_team(session, connection, text)
% The robots that the names of a team mean in a recording that is played, where claim tells no ids.
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

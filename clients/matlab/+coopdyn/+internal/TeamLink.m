% SPDX-License-Identifier: MIT
classdef TeamLink < handle
%TEAMLINK A connection to /swarm that owns all robots of a team.
  properties
    text                          % the names as given by the program
    number                        % distinguishes the teams of one sim
    connection
    is_team = true
    selected = 'pose distances'
    neighbours = 8
    names = {}
    ids = zeros(1, 0)
    readings = {}                 % in the order of a row
    columns = zeros(1, 0)         % of each reading
    stale = false                 % the members must be queried again
    reply = []                    % to the last step
    gone = {}                     % robots lost since the team's last step
    lost = ''                     % why this sim no longer drives the team
    playing = ''                  % error text if a recording is played, and the team only reads; else ''
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
    % (Re)opens the connection: hello takes over from an older connection of this client, claim claims the robots.
      c = t.connection;
      c.open();
      try
        if isempty(t.names)
          c.request(8, [], []);  % drop the robots of an older team
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
    % Makes the connection ready for a request.
      if session.closed || ~isempty(t.lost)
        session.require_open();
        coopdyn.internal.fail(t.lost_code, t.lost);
      end
      c = t.connection;
      if ~c.idle  % not reopened, or interrupted
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
    % Claims the robots; while a recording is played, only looks them up.
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
    % Claims the robots if a branch has ended the playback. Error while a recording is played.
      t.settle(session);
      if ~isempty(t.playing)
        t.take(session);
      end
      if ~isempty(t.playing)
        coopdyn.internal.fail(5, t.playing);
      end
    end

    function reply = read(t, session)
    % Returns the readings of the newest step.
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
        [t.names, t.ids] = find_team(session, t.connection, t.text);  % the recording has other robots at this moment
        reply = t.ask(session, 112, t.ids);
      end
      t.choose(t.selected, t.neighbours);
      % For robots that the team does not own, the reply to select_readings lacks the number of distances.
      at = strcmp(t.readings, 'distances');
      t.columns(at) = t.columns(at) + reply.params(end) - sum(t.columns);
    end

    function reply = ask(t, session, command, params)
    % Sends a request that is answered immediately.
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
    % Claims the team's previous robots, not those that its name refers to now, and none that another team has.
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
        reply = c.request(113, [], []);  % no robot is left
        return
      end
      reply = c.request(7, [], [], t.text);
    end

    function named(t, reply, session)
    % Stores the team's members. A team that has lost all its robots is lost, too.
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
    % The request that makes n steps with the present speeds: ready.
      number = 2;
      bytes = typecast(int32([24 0 2 0 1 0 n]), 'uint8');
    end

    function step = stepped(t, session, reply)
    % Stores the reply to a step; returns its step.
      if reply.error ~= 0
        t.stale = true;  % it may have lost a robot
        coopdyn.internal.check_reply(reply, [t.label ': ']);
      end
      newest = reply.data(end - 1:end);
      step = newest(2);
      session.newest = newest;
      session.mode = reply.params(1);
      t.reply = reply;
    end

    function refresh(t, session)
    % Queries the members and the columns of a row again, after robots or targets were added or removed.
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
    % Releases the robots; stops them before if `stop`.
      c = t.connection;
      if isempty(t.lost) && ~isempty(c.socket)
        try
          if c.idle && stop  % else interrupted: closing drops the pending reply
            c.request(114, [], [], '', 1);
          end
          if c.idle
            c.request(8, [], [], '', 1);
          end
        catch
          % already closed
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
% Looks up the robots of a team in a played recording, where claim returns no ids.
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
      words = [words swarms];  % `swarm1`, the section, stands for the only swarm
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
% The ids of the n robots in ascending order, with gaps where robots have been removed.
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

% SPDX-License-Identifier: MIT
classdef TeamLink < handle
%TEAMLINK A team as this client drives it: one connection to /swarm, which owns all its robots.
  properties
    text                          % the names as they were asked for
    number                        % tells the teams of one sim apart
    label
    connection
    is_team = true
    selected = 'pose distances'
    neighbours = 8
    names = {}
    ids = zeros(1, 0)
    readings = {}                 % in the order of a row
    columns = zeros(1, 0)         % of each
    stale = false                 % who is in it must be asked anew
    reply = []                    % to the step that ran last
    lost = ''                     % why it is not ours any more
    lost_code = 6
  end
  methods
    function t = TeamLink(address, text, number)
      t.text = text;
      t.number = number;
      t.label = 'the team';
      if ~isempty(text)
        t.label = ['team ' text];
      end
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
        t.named(t.claim());
        t.choose(t.selected, t.neighbours);
        session.note(c.request(3, [], []));
      catch cause
        c.close();
        rethrow(cause);
      end
    end

    function reopen(t, session)
      t.open(session);
    end

    function settle(t, session)
    % Makes the connection free for a request.
      session.require_open();
      if ~isempty(t.lost)
        coopdyn.internal.fail(t.lost_code, t.lost);
      end
      c = t.connection;
      if isempty(c.socket) || c.busy  % never opened again, or interrupted
        t.open(session);
      elseif t.stale
        t.named(c.request(113, [], []));
      end
    end

    function reply = ask(t, session, command)
    % A request that is answered at once.
      t.settle(session);
      try
        reply = t.connection.request(command, [], []);
      catch cause
        session.lose(t, cause);
      end
      session.note(reply);
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

    function reply = claim(t)
      c = t.connection;
      if isempty(t.text) && ~isempty(t.names)
        try  % again all that were free, not what is free by now
          reply = c.request(7, [], [], strjoin(t.names, ' '));
          return
        catch cause
          if ~strcmp(cause.identifier, 'coopdyn:no_such_name')
            rethrow(cause);
          end
        end
      end
      reply = c.request(7, [], [], t.text);
    end

    function named(t, reply)
    % Takes over who is in the team.
      t.stale = false;
      t.ids = reply.params;
      t.names = {};
      if ~isempty(strtrim(reply.text))
        t.names = strsplit(strtrim(reply.text), ' ');
      end
    end

    function refresh(t, session)
    % What of a row changes if robots or targets have come or gone.
      t.named(t.ask(session, 113));
      t.choose(t.selected, t.neighbours);
    end

    function text = take_again(t)
      text = 'sim.team()';
      if ~isempty(t.text)
        text = ['sim.team(''' t.text ''')'];
      end
    end

    function give_up(t, stop)
    % Gives the robots up, after stopping them if wished.
      c = t.connection;
      if isempty(t.lost) && ~isempty(c.socket)
        try
          if c.busy
            stop = false;  % interrupted: closing ends what waits
          end
          if stop
            c.request(114, [], [], '', 1);
          end
          if ~c.busy
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

% SPDX-License-Identifier: MIT
classdef Session < handle
%SESSION The connections of one connect, shared by the simulation and its robots; refers to neither of them.
  properties
    address
    watch
    simulation       % connection to /simulation
    links = {}
    teams = {}
    others = {}      % connections of call
    described = {}   % names and numbers of commands, by module: {module, names, ids; ...}
    mode = 0
    newest = [0 0]   % time [s] and step of the newest reply
    closed = false
  end
  methods
    function s = Session(address, watch)
      s.address = address;
      s.watch = logical(watch);
      s.simulation = coopdyn.internal.Connection(address, '/simulation', true);
    end

    function note(s, reply)
    % Takes time and step out of a reply, and the mode if it carries one.
      data = reply.data;
      if numel(data) >= 2
        s.newest = data(end - 1:end);
      end
      if ~isempty(reply.params)
        switch reply.command
          case {2, 3, 10, 11, 14, 110}
            s.mode = reply.params(1);
        end
      end
    end

    function require_open(s)
      if s.closed
        coopdyn.internal.fail(-1, 'this sim is closed; connect again');
      end
    end

    % --- requests that are answered at once
    function reply = control(s, command, params, data, text, limit)
    % A request to /simulation.
      if nargin < 6, limit = 10; end
      if nargin < 5, text = ''; end
      if nargin < 4, data = []; end
      if nargin < 3, params = []; end
      s.require_open();
      if ~s.simulation.alive()
        s.simulation.open();
      end
      reply = s.simulation.request(command, params, data, text, limit);
      for k = 1:numel(s.links)
        link = s.links{k};
        link.carried = [];
      end
      s.note(reply);
    end

    function reply = read(s, link, module, command, params, text, data)
    % A reading of the newest frame.
      if nargin < 7, data = []; end
      s.require_open();
      if strcmp(module, 'motors') && ~isempty(link.motors) && isempty(link.lost)
        s.settle(link);
        reply = link.motors.request(command, params, [], text);
        s.note(reply);
        return
      end
      c = s.reader(link, module, module);
      try
        reply = s.ask(c, command, params, text, data);
      catch cause
        if isempty(c.socket) && strcmp(module, 'neighbours') && strcmp(cause.identifier, 'coopdyn:no_such_name')
          coopdyn.internal.fail(5, [link.robot ' has no module neighbours, its type has none: a robot of type minibot ' ...
            'has one, or add it to the robot''s model.sdf (docs/formats.md)']);
        end
        rethrow(cause);
      end
    end

    function c = reader(s, link, key, module)
      if ~isfield(link.readers, key)
        sends = strcmp(module, 'neighbours') && ~s.watch;  % what a robot sends is its driver's to say
        link.readers.(key) = coopdyn.internal.Connection(s.address, ['/' link.robot '/' module], sends);
      end
      c = link.readers.(key);
    end

    function reply = ask(s, c, command, params, text, data)
    % A request that may be repeated: a connection that broke since it was last used is opened again.
      if nargin < 6, data = []; end
      if ~isempty(c.socket) && ~c.busy
        try
          reply = c.request(command, params, data, text);
          s.note(reply);
          return
        catch cause
          if ~strcmp(cause.identifier, 'coopdyn:connection')
            rethrow(cause);
          end
        end
      end
      c.open();
      reply = c.request(command, params, data, text);
      s.note(reply);
    end

    % --- driving
    function link = drive(s, robot)
    % The link to a robot, opened and (unless watching) claimed.
      s.require_open();
      in_team = false;
      for k = 1:numel(s.teams)
        in_team = in_team || any(strcmp(s.teams{k}.names, robot));
      end
      keep = true(1, numel(s.links));
      for k = 1:numel(s.links)
        link = s.links{k};
        if strcmp(link.robot, robot)
          if isempty(link.lost) && link.in_team == in_team
            return
          end
          keep(k) = false;
        end
      end
      link = coopdyn.internal.Link(s.address, robot, ~s.watch);
      if in_team
        link.in_team = true;
        link.motors = [];
        s.links = [s.links(keep) {link}];
        return
      end
      try
        s.open_motors(link);
      catch cause
        if ~strcmp(cause.identifier, 'coopdyn:no_such_name')
          rethrow(cause);
        end
        modules = coopdyn.internal.ask_names(s.address);
        names = {modules.name};
        if ~any(strncmp(names, ['/' robot '/'], numel(robot) + 2))
          found = regexp(names, '^/([^/]+)/', 'tokens', 'once');
          robots = unique(cellfun(@(t) t{1}, found(~cellfun(@isempty, found)), 'UniformOutput', false));
          coopdyn.internal.fail(10, ['there is no robot ''' robot '''; ' coopdyn.internal.nearest(robot, robots) ...
            'there are: ' coopdyn.internal.list_of(robots)]);
        end
        link.motors = [];  % it has no motors: it can be read only
      end
      s.links = [s.links(keep) {link}];
    end

    function open_motors(s, link)
    % Opens (again) the connection that commands go through: hello takes the module back, claim makes it ours.
      link.sent = [];
      link.carried = [];
      link.drives = false;
      c = link.motors;
      c.open();
      try
        if ~s.watch
          try
            link.claim();
          catch cause
            if ~strcmp(cause.identifier, 'coopdyn:not_possible')  % a recording is played; reading goes on
              rethrow(cause);
            end
          end
        end
        if ~isempty(link.attached)
          c.request(9, [], [], strjoin(link.attached, ' '));
        end
        s.note(c.request(3, [], []));
        link.drives = ~s.watch && ~link.unclaimed;
      catch cause
        c.close();
        rethrow(cause);
      end
    end

    function settle(s, link)
    % Makes the motors connection free for a request: opens it if it broke, takes in a reply that is overdue.
      if ~isempty(link.lost)
        coopdyn.internal.fail(link.lost_code, link.lost);
      end
      c = link.motors;
      if isempty(c.socket) || (c.busy && isempty(link.sent))  % interrupted, or never opened again
        s.open_motors(link);
      end
      if isempty(link.sent) || s.await_command(link)
        return
      end
      % No reply: in lockstep it comes after the step only. Take the command back, and keep it.
      reply = s.control(3);
      if reply.params(1) == 1
        if isempty(link.kept)
          link.kept = link.sent;
        end
        s.open_motors(link);
      else
        reply = c.receive(10);
        link.sent = [];
        coopdyn.internal.check_reply(reply, '');
        s.note(reply);
      end
    end

    function came = await_command(s, link)
    % Waits at most 0.1 s for the reply to a command.
      c = link.motors;
      started = [];
      while true
        try
          reply = c.poll(isempty(started));
        catch cause
          s.lose(link, cause);
        end
        came = ~isempty(reply);
        if came
          link.sent = [];
          coopdyn.internal.check_reply(reply, '');
          s.note(reply);
          return
        end
        if isempty(started)
          started = tic;
        elseif toc(started) > 0.08
          return
        end
        pause(0.001);
      end
    end

    function command(s, link, number, data)
    % An actuator command: kept in lockstep, sent at once otherwise.
      s.require_open();
      if s.watch
        coopdyn.internal.fail(5, 'this sim only watches; connect without ''watch'' to drive');
      end
      if isempty(link.motors)
        if link.in_team
          coopdyn.internal.fail(5, [link.robot ' is driven by its team']);
        end
        coopdyn.internal.fail(5, [link.robot ' has no motors']);
      end
      if ~isempty(link.lost)
        coopdyn.internal.fail(link.lost_code, link.lost);
      end
      if s.mode ~= 1 || link.unclaimed
        s.settle(link);
      end
      if link.unclaimed
        link.claim();  % a branch may go on live from there, in another mode
        s.note(link.motors.request(3, [], []));
        link.drives = true;
      end
      if s.mode == 1
        link.kept = {number, data};
        return
      end
      link.kept = [];
      try
        link.motors.send(number, coopdyn.internal.encode(number, [], data));
      catch cause
        s.lose(link, cause);
      end
      link.sent = {number, data};
      s.await_command(link);
    end

    % --- teams
    function team = team(s, text)
    % The team of these names, opened and claimed.
      s.require_open();
      if s.watch
        coopdyn.internal.fail(5, 'this sim only watches; connect without ''watch'' to drive a team');
      end
      s.drop_lost_teams();
      numbers = zeros(1, 0);
      for k = 1:numel(s.teams)
        team = s.teams{k};
        if strcmp(team.text, text)
          return
        end
        numbers(end + 1) = team.number; %#ok<AGROW>
      end
      for k = 1:numel(s.teams)  % what one of ours lets go of for a moment is not free
        other = s.teams{k};
        if isempty(other.connection.socket) || other.connection.busy
          try
            other.settle(s);
          catch
            % its next use says what is wrong
          end
        end
      end
      team = coopdyn.internal.TeamLink(s.address, text, min(setdiff(1:numel(numbers) + 1, numbers)));
      try
        team.open(s);
      catch cause
        if strcmp(cause.identifier, 'coopdyn:owned')
          robot = coopdyn.internal.first_word(cause.message);
          for k = 1:numel(s.teams)
            other = s.teams{k};
            if isempty(other.lost) && any(strcmp(other.names, robot))
              coopdyn.internal.fail(6, ['robot ' robot ' belongs to your ' other.label ': drive it there, or release ' ...
                'that team first']);
            end
          end
          label = ['the team with ' robot];
          if team.one_word()
            label = team.label;
          end
          coopdyn.internal.fail(6, [label ' cannot be driven: ' cause.message '. Stop the other program, or free ' ...
            'the robot on the page']);
        end
        rethrow(cause);
      end
      if isempty(team.names)
        team.connection.close();
        coopdyn.internal.fail(10, 'there is no robot that nobody drives');
      end
      s.teams{end + 1} = team;
    end

    function drop_lost_teams(s)
      s.teams = s.teams(cellfun(@(t) isempty(t.lost), s.teams));
    end

    function reply = step_team(s, team, bytes, limit)
    % One step of the world, in which the team does what the bytes say.
      s.step(1, limit, team, bytes);
      reply = team.reply;
      team.reply = [];
      team.gone = {};
    end

    % --- a step of the world
    function step(s, n, limit, commanded, bytes)
    % Sends what was kept (or ready) for every robot and every team of this sim, then takes in the replies. One of the
    % teams may be commanded otherwise: bytes.
      links = s.links;
      if isempty(links) && numel(s.teams) == 1 && nargin > 3
        % One team alone: the same as below with less to do, if its connection is in order.
        c = commanded.connection;
        if ~c.busy && ~isempty(c.socket) && ~s.closed
          s.step_one_team(commanded, c, bytes, limit);
          return
        end
      end
      if numel(links) == 1 && isempty(s.teams) && ~s.watch
        % One robot: the same as below with less to do, if its connection is in order.
        link = links{1};
        c = link.motors;
        if ~isempty(c) && ~c.busy && ~isempty(c.socket)
          s.step_one(link, c, n, limit);
          return
        end
      end
      s.require_open();
      connections = {};
      links = {};
      if ~s.watch
        for k = 1:numel(s.links)
          link = s.links{k};
          if ~isempty(link.motors)
            if ~isempty(link.lost) || ~isempty(link.sent) || link.motors.busy || isempty(link.motors.socket)
              s.settle(link);
            end
            links{end + 1} = link; %#ok<AGROW>
            connections{end + 1} = link.motors; %#ok<AGROW>
          end
        end
        for k = 1:numel(s.teams)
          team = s.teams{k};
          try
            team.settle(s);
          catch cause
            if isempty(team.lost) || nargin > 3 && team.number == commanded.number
              rethrow(cause);
            end
            continue  % the others go on without it
          end
          links{end + 1} = team; %#ok<AGROW>
          connections{end + 1} = team.connection; %#ok<AGROW>
        end
        s.drop_lost_teams();
      end
      if isempty(links)
        if ~s.simulation.alive()
          s.simulation.open();
        end
        links = {[]};
        connections = {s.simulation};
      end
      waiting = true(1, numel(links));
      current = 1;
      try
        for current = 1:numel(links)
          link = links{current};
          c = connections{current};
          number = 2;
          data = [];
          if ~isempty(link) && link.is_team
            if nargin > 3 && link.number == commanded.number
              c.send(110, bytes);
            else
              c.send(2, coopdyn.internal.encode(2, n, []));
            end
            continue
          end
          if ~isempty(link)
            if ~isempty(link.kept)
              number = link.kept{1};
              data = link.kept{2};
              link.kept = [];
            end
            link.carried = [];
          end
          c.send(number, coopdyn.internal.encode(number, n, data));
        end
        coopdyn.internal.collect(s, connections, links, limit);
      catch cause
        s.give_up(connections, links, cause);
      end
    end

    function step_one(s, link, c, n, limit)
      kept = link.kept;
      if isempty(kept)
        number = 2;
        bytes = typecast(int32([24 0 2 0 1 0 n]), 'uint8');
      else
        number = kept{1};
        data = kept{2};
        k = numel(data);
        bytes = typecast(int32([24 + 8 * k, 0, number, 0, 1, k, n]), 'uint8');
        if k > 0
          bytes = [bytes typecast(data, 'uint8')];
        end
        link.kept = [];
      end
      try
        reply = c.exchange(number, bytes);
        if isempty(reply)
          link.carried = [];
          coopdyn.internal.collect(s, {c}, {link}, limit);
          return
        end
        if reply.error ~= 0
          coopdyn.internal.check_reply(reply, [link.robot ': ']);
        end
      catch cause
        s.give_up({c}, {link}, cause);
      end
      s.newest = reply.data(end - 1:end);
      mode = reply.params(1);
      if mode ~= s.mode
        s.mode = mode;
      end
      if mode == 1
        link.carried = reply;
      else
        link.carried = [];
      end
    end

    function step_one_team(s, team, c, bytes, limit)
      try
        reply = c.exchange(110, bytes);
        if isempty(reply)
          coopdyn.internal.collect(s, {c}, {team}, limit);
          return
        end
        if reply.error ~= 0
          team.stale = true;  % a robot may have been taken from it
          coopdyn.internal.check_reply(reply, [team.label ': ']);
        end
      catch cause
        s.give_up({c}, {team}, cause);
      end
      s.note(reply);
      team.reply = reply;
    end

    function give_up(s, connections, links, cause)
    % Connections that still wait for a reply are closed and opened again: reading on would take the next reply for the
    % one that is missing. Raises the cause.
      raised = cause;
      again = {};
      for k = 1:numel(connections)
        c = connections{k};
        link = links{k};
        gone = isempty(c.socket);
        if ~gone && ~c.busy
          continue  % it has had its reply, or nothing was sent
        end
        c.close();
        if isempty(link)
          continue
        end
        link.forget_commands();
        if gone && strcmp(cause.identifier, 'coopdyn:connection')
          try
            s.lose(link, cause);
          catch raised
          end
        end
        again{end + 1} = link; %#ok<AGROW>
      end
      for k = 1:numel(again)
        link = again{k};
        if isempty(link.lost)
          try
            link.reopen(s);
          catch
            % tried again at the next use, which says what is wrong
          end
        end
      end
      for k = 1:numel(s.teams)
        team = s.teams{k};
        if team.stale && isempty(team.lost)
          try
            team.settle(s);
          catch again
            if ~isempty(team.lost)
              raised = again;  % else likewise
            end
          end
        end
      end
      rethrow(raised);
    end

    function lose(s, link, cause)
    % The motors connection was closed by the daemon. If the robot was taken over or freed it is not opened again by
    % itself: that would take it back from whoever got it. Raises what happened.
      if ~strcmp(cause.identifier, 'coopdyn:connection')
        rethrow(cause);
      end
      link.forget_commands();
      if link.is_team
        why = link.connection.notice;
      else
        link.drives = false;
        why = link.motors.notice;
      end
      if isempty(why)  % Octave loses a notice that comes together with the end of the connection
        why = coopdyn.internal.new_owner(s.address, link.names{1});
      end
      if isempty(why)
        coopdyn.internal.fail(-1, ['the connection to ' link.label ' broke; is the daemon still running?']);
      end
      link.lost = [link.label ' is not driven by this sim any more: ' why '; ' link.take_again() ' takes it again'];
      link.lost_code = 6;
      coopdyn.internal.fail(6, link.lost);
    end

    function started_anew(s)
    % After a reset or load of ours: what was kept belongs to the old world.
      for k = 1:numel(s.links)
        link = s.links{k};
        link.forget_commands();
      end
      for k = 1:numel(s.teams)
        team = s.teams{k};
        team.stale = true;
      end
    end

    function close(s)
    % Writes stop to the robots of this sim and closes everything. Does not wait for the step, but lets the daemon read
    % the stop, so that what the program does next, a reset say, comes after it.
      for k = 1:numel(s.teams)
        team = s.teams{k};
        team.give_up(true);
      end
      s.teams = {};
      stopping = {};
      for k = 1:numel(s.links)
        link = s.links{k};
        if ~isempty(link.motors) && ~s.watch && isempty(link.lost) && link.motors.alive()
          try
            link.motors.send(14, coopdyn.internal.encode(14, [], []));
            stopping{end + 1} = link.motors;
          catch
            % it is gone already
          end
        end
      end
      started = tic;
      for k = 1:numel(stopping)
        while ~stopping{k}.has_bytes() && toc(started) < 0.2
          pause(0.001);
        end
      end
      for k = 1:numel(s.links)
        link = s.links{k};
        link.forget_commands();
        link.close();
      end
      for k = 1:numel(s.others)
        c = s.others{k};
        c.close();
      end
      s.simulation.close();
      s.closed = true;
    end
  end
end

% SPDX-License-Identifier: MIT
classdef Session < handle
%SESSION The connections of one connect, shared by the simulation and its robots; refers to neither of them.
  properties
    address
    watch
    simulation       % connection to /simulation
    links = {}
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
          case {2, 3, 10, 11, 14}
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

    function reply = read(s, link, module, command, params, text)
    % A reading of the newest frame.
      s.require_open();
      if strcmp(module, 'motors') && ~isempty(link.motors) && isempty(link.lost)
        s.settle(link);
        reply = link.motors.request(command, params, [], text);
        s.note(reply);
        return
      end
      reply = s.ask(s.reader(link, module, module), command, params, text);
    end

    function c = reader(s, link, key, module)
      if ~isfield(link.readers, key)
        link.readers.(key) = coopdyn.internal.Connection(s.address, ['/' link.robot '/' module]);
      end
      c = link.readers.(key);
    end

    function reply = ask(s, c, command, params, text)
    % A request that may be repeated: a connection that broke since it was last used is opened again.
      if ~isempty(c.socket) && ~c.busy
        try
          reply = c.request(command, params, [], text);
          s.note(reply);
          return
        catch cause
          if ~strcmp(cause.identifier, 'coopdyn:connection')
            rethrow(cause);
          end
        end
      end
      c.open();
      reply = c.request(command, params, [], text);
      s.note(reply);
    end

    % --- driving
    function link = drive(s, robot)
    % The link to a robot, opened and (unless watching) claimed.
      s.require_open();
      keep = true(1, numel(s.links));
      for k = 1:numel(s.links)
        link = s.links{k};
        if strcmp(link.robot, robot)
          if isempty(link.lost)
            return
          end
          keep(k) = false;
        end
      end
      link = coopdyn.internal.Link(s.address, robot, ~s.watch);
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
          coopdyn.internal.fail(10, ['there is no robot ''' robot '''; there are: ' strjoin(robots, ', ')]);
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
            c.request(7, [], []);
          catch cause
            if strcmp(cause.identifier, 'coopdyn:owned')
              coopdyn.internal.fail(6, [link.robot ' cannot be driven: ' cause.message '. Stop the other program, or ' ...
                'free the robot on the page; to look on only: coopdyn.connect(''watch'', true)']);
            end
            if ~strcmp(cause.identifier, 'coopdyn:not_possible')  % a recording is played; reading goes on
              rethrow(cause);
            end
          end
        end
        if ~isempty(link.attached)
          c.request(9, [], [], strjoin(link.attached, ' '));
        end
        s.note(c.request(3, [], []));
        link.drives = ~s.watch;
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
        coopdyn.internal.fail(5, [link.robot ' has no motors']);
      end
      if ~isempty(link.lost)
        coopdyn.internal.fail(link.lost_code, link.lost);
      end
      if s.mode ~= 1
        s.settle(link);
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

    function step(s, n, limit)
    % Sends what was kept (or ready) to every robot of this sim, then takes in the replies.
      links = s.links;
      if numel(links) == 1 && ~s.watch
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
          number = 2;
          data = [];
          if ~isempty(link)
            if ~isempty(link.kept)
              number = link.kept{1};
              data = link.kept{2};
              link.kept = [];
            end
            link.carried = [];
          end
          c = connections{current};
          c.send(number, coopdyn.internal.encode(number, n, data));
        end
        s.collect(connections, links, limit);
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
          s.collect({c}, {link}, limit);
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

    function collect(s, connections, links, limit)
    % Takes in the reply of every connection; the first error is raised.
      waiting = 1:numel(connections);
      stepped = [];
      stepped_s = Inf;
      started = [];
      noticed = false;
      checked = 0;
      patient = true;  % the next poll may wait a little: one such poll a round
      while true
        left = [];
        for k = waiting
          c = connections{k};
          reply = c.poll(patient);
          if isempty(reply)
            patient = false;
            left(end + 1) = k; %#ok<AGROW>
            continue
          end
          link = links{k};
          if reply.error ~= 0
            who = '';
            if ~isempty(link)
              who = [link.robot ': '];
            end
            coopdyn.internal.check_reply(reply, who);
          end
          s.note(reply);
          stepped(end + 1) = k; %#ok<AGROW>
          stepped_s = 0;
          if ~isempty(started)
            stepped_s = toc(started);
          end
          if ~isempty(link) && reply.params(1) == 1
            link.carried = reply;
          end
        end
        waiting = left;
        if isempty(waiting)
          return
        end
        if isempty(started)
          started = tic;
        end
        now_s = toc(started);
        if now_s > limit
          coopdyn.internal.fail(11, sprintf('the step did not come within %g s; %s', limit, s.whom()));
        end
        if now_s > 2 && ~noticed
          noticed = true;
          fprintf(2, 'coopdyn: %s\n', s.whom());
        end
        if now_s - stepped_s > 0.1
          stepped_s = now_s;
          behind = s.catch_up(connections, links, stepped);
          stepped = setdiff(stepped, behind);
          waiting = [waiting behind]; %#ok<AGROW>
        end
        patient = now_s - checked > 0.5;  % sees a peer that is gone
        if patient
          checked = now_s;
        end
        pause(0.001);
      end
    end

    function again = catch_up(s, connections, links, stepped)
    % After an error or a timeout a command that had not run may still run while its successor is on the way: its robot
    % is then one step behind the others, and each would wait for the other for ever. The world says whether it waits
    % for robots of ours that have stepped already: these go on by one step with what they have.
      again = [];
      status = s.fresh_status();
      for k = 1:numel(status.awaiting)
        for j = stepped
          link = links{j};
          if ~isempty(link) && strcmp(link.robot, status.awaiting(k).robot)
            c = connections{j};
            c.send(2, coopdyn.internal.encode(2, 1, []));
            again(end + 1) = j; %#ok<AGROW>
          end
        end
      end
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
            s.open_motors(link);
          catch
            % tried again at the next use, which says what is wrong
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
      link.drives = false;
      why = link.motors.notice;
      if isempty(why)  % Octave loses a notice that comes together with the end of the connection
        why = s.new_owner(link.robot);
      end
      if isempty(why)
        coopdyn.internal.fail(-1, ['the connection to ' link.robot ' broke; is the daemon still running?']);
      end
      link.lost = [link.robot ' is not driven by this sim any more: ' why '; sim.robot(''' link.robot ''') takes it again'];
      link.lost_code = 6;
      coopdyn.internal.fail(6, link.lost);
    end

    function why = new_owner(s, robot)
      why = '';
      try
        status = s.fresh_status();
      catch
        return
      end
      for k = 1:numel(status.robots)
        if strcmp(status.robots(k).name, robot)
          owner = char(status.robots(k).owner);
          if isempty(owner)
            why = 'it was freed';
          else
            why = ['it is driven by ' owner];
          end
          return
        end
      end
      why = 'it is not there any more';
    end

    function status = fresh_status(s)
    % The status, asked on a connection of its own.
      c = coopdyn.internal.Connection(s.address, '/simulation');
      c.open();
      reply = c.request(100, [], [], '', 1);
      c.close();
      status = jsondecode(reply.text);
    end

    function text = whom(s, held_up)
    % One line that says what the world waits for; with held_up empty if its steps go on: lockstep awaits its robots
    % before every step, and a wait of less than 0.5 s holds nobody up.
      try
        status = s.fresh_status();
      catch cause
        text = ['no answer from the daemon (' cause.message ')'];
        return
      end
      if strcmp(status.state, 'paused')
        text = 'the simulation is paused; sim.run() or the page goes on';
        return
      elseif strcmp(status.state, 'ended')
        text = 'the run has ended; sim.reset() starts again';
        return
      end
      text = '';
      awaiting = status.awaiting;
      if nargin > 1 && held_up && (isempty(awaiting) || max([awaiting.seconds 0]) < 0.5)
        return
      end
      if isempty(awaiting)
        text = ['waiting for the next step, ' status.state];
        return
      end
      named = min(numel(awaiting), 4);
      for k = 1:named
        a = awaiting(k);
        text = sprintf('%s%s (%s), %.1f s, ', text, a.robot, a.why, a.seconds);
      end
      text = ['waiting for ' text(1:end - 2)];
      more = numel(awaiting) - named;
      if isfield(status, 'awaiting_count')
        more = status.awaiting_count - named;
      end
      if more > 0
        text = sprintf('%s and %d more', text, more);
      end
    end

    function started_anew(s)
    % After a reset or load of ours: what was kept belongs to the old world.
      for k = 1:numel(s.links)
        link = s.links{k};
        link.forget_commands();
      end
    end

    function c = other(s, name)
    % The connection of call to any module.
      for k = 1:numel(s.others)
        c = s.others{k};
        if strcmp(c.module, name)
          return
        end
      end
      c = coopdyn.internal.Connection(s.address, name, ~s.watch);
      s.others{end + 1} = c;
    end

    function d = describe(s, name)
    % What a module says about its commands, asked on a connection of its own.
      s.require_open();
      c = coopdyn.internal.Connection(s.address, ['/' regexprep(char(name), '^/|/$', '')]);
      reply = s.ask(c, 1, [], '');
      c.close();
      d = jsondecode(reply.text);
    end

    function number = number_of(s, name, command)
    % The number of a command, from the module's own description.
      for k = 1:size(s.described, 1)
        if strcmp(s.described{k, 1}, name)
          entry = s.described(k, :);
        end
      end
      if ~exist('entry', 'var')
        description = s.describe(name);
        commands = description.commands;
        if iscell(commands)
          names = cellfun(@(c) c.name, commands, 'UniformOutput', false);
          ids = cellfun(@(c) c.id, commands);
        else
          names = {commands.name};
          ids = [commands.id];
        end
        entry = {name, names, ids};
        s.described(end + 1, :) = entry;
      end
      at = find(strcmp(entry{2}, command), 1);
      if isempty(at)
        coopdyn.internal.fail(1, [name ' has no command ''' command '''; it has: ' strjoin(reshape(entry{2}, 1, []), ', ')]);
      end
      number = entry{3}(at);
    end

    function reply = call(s, name, command, params, data, text, limit)
    % The raw message.
      s.require_open();
      name = ['/' regexprep(char(name), '^/|/$', '')];
      if ~isnumeric(command)
        command = s.number_of(name, char(command));
      end
      params = double(params);
      if any(params ~= round(params)) || any(abs(params) > 2147483648)
        coopdyn.internal.fail(2, 'params are whole numbers of 32 bits');
      end
      owner = [];
      for k = 1:numel(s.links)
        link = s.links{k};
        link.carried = [];
        if ~isempty(link.motors) && strcmp(link.motors.module, name)
          owner = link;
        end
      end
      if ~isempty(owner)
        s.settle(owner);
        c = owner.motors;
      else
        if strcmp(name, '/simulation')
          c = s.simulation;
        else
          c = s.other(name);
        end
        if ~c.alive()
          c.open();
        end
      end
      try
        c.send(command, coopdyn.internal.encode(command, params, data, text));
        message = s.await_one(c, limit);
      catch cause
        s.give_up({c}, {owner}, cause);
      end
      coopdyn.internal.check_reply(message, '');
      s.note(message);
      reply = struct('text', message.text, 'command', message.command, 'params', message.params, ...
                     'data', message.data(1:end - 2), 'time', message.data(end - 1), 'step', message.data(end));
    end

    function message = await_one(s, c, limit)
    % The reply to a raw message, which may have to wait for a step; says once whom for.
      message = c.poll(true);
      started = tic;
      noticed = false;
      checked = 0;
      while isempty(message)
        now_s = toc(started);
        if now_s > limit
          coopdyn.internal.fail(11, sprintf('no answer from %s within %g s; %s', c.module, limit, s.whom()));
        end
        if now_s > 2 && ~noticed
          noticed = true;
          fprintf(2, 'coopdyn: %s\n', s.whom());
        end
        pause(0.001);
        patient = now_s - checked > 0.5;
        if patient
          checked = now_s;
        end
        message = c.poll(patient);
      end
    end

    function close(s)
    % Writes stop to the robots of this sim and closes everything. Does not wait for the step, but lets the daemon read
    % the stop, so that what the program does next, a reset say, comes after it.
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

% SPDX-License-Identifier: MIT
classdef Session < handle
%SESSION The connections of one connect, shared by the simulation and its robots; has no references to them.
  properties
    address
    watch
    links = {}
    teams = {}
    others = {}      % connections to modules of the whole simulation, and of call
    described = {}   % names and numbers of commands, by module: {module, names, ids; ...}
    actuators = cell(0, 3)  % robot, names and types of its actuator modules; empty = not queried yet
    mode = 0
    newest = [0 0]   % time [s] and step of the newest reply
    reached = 0      % the newest step of this world reported by a reading, command or step; 0 again after a reset
    scenario = ''    % name of the present world's scenario
    told_to_step = false
    closed = false
    process = 0      % of the daemon started by coopdyn.launch; 0: none
  end
  methods
    function s = Session(address, watch)
      s.address = address;
      s.watch = logical(watch);
    end

    function note(s, reply)
    % Stores the reply's time and step, and its mode if it carries one.
      data = reply.data;
      if numel(data) >= 2
        s.newest = data(end - 1:end);
      end
      if ~isempty(reply.params)
        switch reply.command
          case {2, 3, 10, 11, 14, 110, 204, 205, 206, 207, 208, 219, 222, 224, 227, 351}
            s.mode = reply.params(1);
        end
      end
    end

    function go_on(s, step, since)
    % Checks the reply's step against `since`, the step that the world had reached when the request was sent: raises
    % coopdyn:reset if `step` is earlier, except in a playback, where time may go back.
      if step < since && ~s.watch
        status = s.brief_status();
        if ~isfield(status, 'playback') || isempty(status.playback)
          s.new_world('');
        end
      end
      if step < since || step > s.reached
        s.reached = step;
      end
    end

    function new_world(s, word)
    % Raises coopdyn:reset: another client has reset the world or (word is 'load', or the scenario differs) loaded a
    % scenario. Discards the state of the old world.
      before = s.scenario;
      s.note_scenario();
      cure = ': run your program again, or catch this to start over';
      if ~strcmp(word, 'load') && strcmp(s.scenario, before)
        s.started_anew();
        coopdyn.internal.raise('coopdyn:reset', ['the world was reset' cure]);
      end
      gone = coopdyn.internal.loaded(s);
      which = 'a scenario was loaded';
      if ~isempty(s.scenario)
        which = ['scenario ' s.scenario ' was loaded'];
      end
      if ~isempty(gone)
        cure = [', which has no ' coopdyn.internal.list_of(gone) '; there are: ' ...
                coopdyn.internal.list_of(coopdyn.internal.robot_names(s)) '. Run your program again with these'];
      end
      coopdyn.internal.raise('coopdyn:reset', [which cure]);
    end

    function raise_if_loaded(s, cause)
    % After an error of a team: raises coopdyn:reset if a scenario was loaded.
      if ~strcmp(cause.identifier, 'coopdyn:reset') && s.is_new(s.brief_status())
        s.new_world('load');
      end
    end

    function yes = is_new(s, status)
    % True if the status belongs to a world that another client has reset or loaded.
      another = isfield(status, 'scenario') && ~strcmp(char(status.scenario), s.scenario);
      plays = isfield(status, 'playback') && ~isempty(status.playback);
      yes = (another || status.step < s.reached) && ~plays;
    end

    function note_scenario(s)
      status = s.brief_status();
      if isfield(status, 'scenario')
        s.scenario = char(status.scenario);
      end
    end

    function status = brief_status(s)
    % The status of the simulation, with one robot.
      reply = s.control(100, [1 1]);
      status = jsondecode(reply.text);
    end

    function require_open(s)
      if s.closed
        coopdyn.internal.fail(-1, 'this sim is closed; connect again');
      end
    end

    % --- requests that are answered immediately
    function c = connection(s, module)
    % The open connection to a module, other than those of the driven robots.
      s.require_open();
      k = 1;
      while k <= numel(s.others) && ~strcmp(s.others{k}.module, module)
        k = k + 1;
      end
      if k > numel(s.others)
        s.others{k} = coopdyn.internal.Connection(s.address, module, ~s.watch || strcmp(module, '/simulation'));
      end
      c = s.others{k};
      if ~c.alive()
        c.open();
      end
    end

    function reply = tell(s, module, command, params, data, text, limit)
    % Sends a request to a module of the whole simulation.
      if nargin < 7, limit = 10; end
      if nargin < 6, text = ''; end
      if nargin < 5, data = []; end
      if nargin < 4, params = []; end
      c = s.connection(module);
      reply = c.request(command, params, data, text, limit);
      s.forget_readings();
      s.note(reply);
    end

    function reply = control(s, varargin)
    % Sends a request to /simulation.
      reply = s.tell('/simulation', varargin{:});
    end

    function reply = read(s, link, module, command, params, text, data)
    % Returns a reading of the newest frame.
      if nargin < 7, data = []; end
      s.require_open();
      link.require_here();
      since = s.reached;
      if strcmp(module, link.actuator) && ~isempty(link.motors) && isempty(link.lost)
        link.settle(s);
        try
          reply = link.motors.request(command, params, data, text);
        catch cause
          coopdyn.internal.lose(s, link, cause);
        end
        s.note(reply);
        s.go_on(reply.data(end), since);
        return
      end
      c = s.reader(link, module, module);
      try
        reply = s.ask(c, command, params, text, data);
      catch cause
        if isempty(c.socket) && strcmp(cause.identifier, 'coopdyn:no_such_name') && ...
            ~any(strcmp(coopdyn.internal.robot_names(s), link.robot))
          s.new_world('load');
        end
        if isempty(c.socket) && strcmp(cause.identifier, 'coopdyn:no_such_name') && link.find_again(s, module, c)
          reply = s.read(link, module, command, params, text, data);
          return
        end
        [type, known] = coopdyn.internal.type_with(module);
        if isempty(c.socket) && known && strcmp(cause.identifier, 'coopdyn:no_such_name')
          if ~isempty(type)
            type = ['a robot of type ' type ' has one, or '];
          end
          coopdyn.internal.fail(5, [link.robot ' has no module ' module ', its type has none: ' type 'add it to the ' ...
            'robot''s model.sdf (docs/formats.md)']);
        end
        rethrow(cause);
      end
      step = reply.data(end);
      if step < since  % sensors with a rate or a delay return an earlier step: query the present one
        now = s.ask(c, 3, [], '');
        step = now.data(end);
      end
      if step < since
        s.go_on(step, since);
      else
        s.reached = step;
      end
    end

    function c = reader(s, link, key, module)
      if ~isfield(link.readers, key)
        sends = strcmp(module, 'neighbours') && ~s.watch;  % only a robot's driver may send its messages
        link.readers.(key) = coopdyn.internal.Connection(s.address, link.path(module), sends);
      end
      c = link.readers.(key);
    end

    function reply = ask(s, c, command, params, text, data)
    % Sends a request that may be repeated: reopens a connection that broke since its last use.
      if nargin < 6, data = []; end
      if c.idle
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

    % --- a step of the world
    function step(s, n, limit)
    % Runs n steps: sends the kept command (or ready) for every robot and team of this sim, then collects the replies.
      if n > 1 && any(cellfun(@(link) link.has_parts() && ~isempty(link.kept), s.links))
        started = tic;
        s.step(1, limit);  % such a command lasts one step
        n = n - 1;
        limit = max(0, limit - toc(started));
      end
      links = s.links;
      alone = numel(links) == 1 && isempty(s.teams) && ~s.watch;
      if alone
        driven = links{1};
        c = driven.motors;
        alone = ~isempty(c) && ~driven.unclaimed && c.idle && ~s.closed;
      end
      if alone  % a single robot with an intact connection: a faster path
        [number, bytes] = driven.frame(n);
        s.step_one(driven, c, number, bytes, limit);
      else
        coopdyn.internal.step_all(s, n, limit);
      end
    end

    function step_one(s, driven, c, number, bytes, limit)
      since = s.reached + 1;
      try
        c.send(number, bytes);
        reply = c.answer(number);
        if isempty(reply)
          step = coopdyn.internal.collect(s, {c}, {driven}, limit);
        else
          step = driven.stepped(s, reply);
        end
      catch cause
        coopdyn.internal.recover(s, {c}, {driven}, cause);
      end
      if step < since
        s.go_on(step, since);
      else
        s.reached = step;
      end
    end

    function reply = step_team(s, team, bytes, limit)
    % Runs one step of the world with the command in `bytes` for a team that is ready for a request.
      if isempty(s.links) && numel(s.teams) == 1
        s.step_one(team, team.connection, 110, bytes, limit);
      else
        coopdyn.internal.step_all(s, 1, limit, team, bytes);
      end
      reply = team.reply;
      team.reply = [];
      team.gone = {};
    end

    % --- kept commands of robots and teams
    function forget_readings(s)
    % Discards the readings in the last step's reply, which are outdated.
      for k = 1:numel(s.links)
        link = s.links{k};
        link.carried = [];
      end
    end

    function started_anew(s)
    % After a reset or load: discards kept commands, which belong to the old world.
      s.reached = 0;
      s.actuators = cell(0, 3);
      s.forget_commands();
    end

    function forget_commands(s)
      for k = 1:numel(s.links)
        link = s.links{k};
        link.forget_commands();
        link.another = false;
      end
      for k = 1:numel(s.teams)
        team = s.teams{k};
        team.stale = true;
      end
    end

    function yes = has_team_with(s, robot)
      yes = any(cellfun(@(t) isempty(t.lost) && any(strcmp(t.names, robot)), s.teams));
    end

    function freed = let_go(s, robot)
    % Releases a robot for a team if this program never commanded it. True if released.
      links = s.links(cellfun(@(l) strcmp(l.robot, robot) && ~isempty(l.motors), s.links));
      freed = ~isempty(links) && ~any(cellfun(@(l) l.commanded || l.unclaimed || ~isempty(l.lost), links));
      for k = 1:freed * numel(links)
        links{k}.let_go(s);
      end
    end

    function drop_lost_teams(s)
      s.teams = s.teams(cellfun(@(t) isempty(t.lost), s.teams));
    end

    function close(s)
    % Sends stop to the robots of this sim and closes everything. Does not wait for the step, but gives the daemon time to
    % read the stop, so that the program's next request, e.g. a reset, comes after it. Ends a launched daemon first, because
    % the stop would run another step.
      if s.process > 0
        coopdyn.internal.end_process(s.process);
        s.process = 0;
      end
      for k = 1:numel(s.teams)
        team = s.teams{k};
        team.give_up(true);
      end
      s.teams = {};
      stopping = {};
      for k = 1:numel(s.links)
        link = s.links{k};
        if ~isempty(link.motors) && ~s.watch && ~link.unclaimed && isempty(link.lost) && link.motors.alive()
          try
            last = link.last;
            if isempty(last)
              last = {2, []};  % ready
              at = strcmp(link.type, {'motors', 'joints'});
              if any(at)
                still = [14 219];  % stop, hold
                last{1} = still(at);
              end
            end
            link.motors.send(last{1}, coopdyn.internal.encode(last{1}, [], last{2}));
            stopping{end + 1} = link.motors;
          catch
            % already closed
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
      s.closed = true;
    end
  end
end

% SPDX-License-Identifier: MIT
classdef Simulation < coopdyn.internal.RunCalls
%SIMULATION A connection to a daemon: controls its time and its robots. Made by coopdyn.connect and coopdyn.launch.
%   robot, team, robots, step; time, steps, mode, dt; run, pause, stop_all, reset, reload, load_scenario, set_mode, set_step,
%   set_speed, set_participants, release_robot; status, hash, scores, log, logged, end_run, waiting, snapshot, describe, modules, call, close.
%   Live edits of the world: insert, remove, move, change, rename, undo, redo, world, save_scenario, pick.
%   Saved states: save_state, restore_state, saved_states. Recording: record, stop_recording, note, recording, recordings,
%   fetch_run. Playing a recording: playback, seek, play, set_play_speed, skip, set_loop, branch, open_run, close_run.
%   In lockstep, set_velocity does not wait: the command is kept (the last wins) until sim.step(), which sends the commands
%   of all robots of this sim and waits for the step. In real time, the command is sent immediately, and sim.step() waits for
%   the next step.
  properties (Dependent)
    time   % simulated time [s] of the newest reply
    steps  % step number of the newest reply
    mode   % 'realtime', 'lockstep' or 'free'; queries the daemon
    dt     % length of a step [s]; queries the daemon
  end
  methods
    function sim = Simulation(options)
      address = coopdyn.internal.address(options.server, options.name, options.token, options.timeout, ...
                                         options.seat, options.pin);
      session = coopdyn.internal.Session(address, options.watch);
      if isfield(options, 'process')
        session.process = options.process;  % started by coopdyn.launch
      end
      reply = session.control(100, [], [], '', address.timeout);
      try
        status = jsondecode(reply.text);
        protocol = status.protocol;
      catch
        coopdyn.internal.fail(7, ['what listens at ' address.text ' sent a status that cannot be read']);
      end
      if ~isequal(protocol, 1)
        coopdyn.internal.fail(5, sprintf(['the daemon at %s (version %s) speaks protocol %d, this +coopdyn speaks 1: ' ...
          'take the matlab.zip that the daemon''s page offers'], address.text, char(status.version), protocol));
      end
      if isfield(status, 'scenario')
        session.scenario = char(status.scenario);
      end
      session.control(3);
      sim.session = session;
    end

    % --- robots
    function r = robot(sim, which)
    %ROBOT Claims a robot, by name or number (from 1), for this sim to drive. Error if another client owns it. While a
    %   recording is played, the robot can only be read; after a branch, the first step or command claims it if it is free.
      coopdyn.internal.need(nargin, 2, 'sim.robot(''robot1'') or sim.robot(1)');
      if isnumeric(which)
        number = coopdyn.internal.count(which, 'the number of a robot');
        names = sim.robots();
        if number > numel(names)
          coopdyn.internal.fail(10, sprintf('there is no robot %d; there are: %s', number, coopdyn.internal.list_of(names)));
        end
        which = names{number};
      elseif ~coopdyn.internal.is_text(which)
        coopdyn.internal.fail(3, ['a robot is named or numbered, not ' coopdyn.internal.show(which) '; write ' ...
          'sim.robot(''robot1'') or sim.robot(1)']);
      end
      name = regexprep(strtrim(char(which)), '^/+', '');
      if isempty(regexp(name, '^[^\s/]+$', 'once'))
        coopdyn.internal.fail(10, ['''' name ''' is not the name of a robot; write e.g. sim.robot(''robot1'')']);
      end
      link = coopdyn.internal.take_robot(sim.session, name);
      r = coopdyn.Robot(sim.session, link);
    end

    function names = robots(sim)
    %ROBOTS The names of all robots, in the order of the scenario.
      names = coopdyn.internal.robot_names(sim.session);
    end

    function t = team(sim, names)
    %TEAM Claims robots to be driven together through one connection: the name of a swarm or robot, a cell array of names, or
    %   without names all free robots, in the order of the scenario. Error if another client owns one of them, or if this sim
    %   has driven one singly; then no robot is claimed.
      text = '';
      if nargin > 1
        names = joined(names, ['sim.team(''swarm1''), sim.team({''robot1'', ''robot2''}), or sim.team() ' ...
          'for all that are free']);
        words = strsplit(strtrim(names), ' ');
        words = regexprep(words(~cellfun(@isempty, words)), '^/+', '');
        if isempty(words)
          coopdyn.internal.fail(3, 'no names: write e.g. sim.team(''swarm1''), or sim.team() for all that are free');
        end
        for k = 1:numel(words)
          if isempty(regexp(words{k}, '^[^\s/]+$', 'once'))
            coopdyn.internal.fail(10, ['''' words{k} ''' is not the name of a robot or swarm; write e.g. sim.team(''swarm1'')']);
          end
        end
        text = strjoin(words, ' ');
      end
      link = coopdyn.internal.take_team(sim.session, text);
      t = coopdyn.Team(sim.session, link);
    end

    % --- time
    function step(sim, varargin)
    %STEP Runs one step, or n: sim.step(n). In lockstep: sends the commands of this sim's robots and waits until the steps have
    %   run; otherwise waits for the n-th next step. Teams keep their speeds. sim.step(1, 'timeout', 5): error after 5 s. After
    %   2 s of waiting, reports once which robots the world waits for.
      n = 1;
      limit = Inf;
      if nargin > 1
        if mod(nargin, 2) == 0
          n = coopdyn.internal.count(varargin{1}, 'n');
          if n > 10000000
            coopdyn.internal.fail(4, sprintf(['n must be at most 10000000, not %d: write sim.step(10000000) and the rest ' ...
              'after it'], n));
          end
          varargin(1) = [];
        end
        options = coopdyn.internal.options(varargin, struct('timeout', Inf));
        limit = options.timeout;
      end
      sim.session.step(n, limit);
    end

    function t = get.time(sim)
      t = sim.session.newest(1);
    end

    function k = get.steps(sim)
      k = sim.session.newest(2);
    end

    function word = get.mode(sim)
      reply = sim.session.control(3);
      words = {'realtime', 'lockstep', 'free'};
      word = words{reply.params(1) + 1};
    end

    function s = get.dt(sim)
      status = sim.status();
      s = status.step_s;
    end

    % --- control
    function run(sim)
    %RUN Runs the simulation after a pause.
      sim.session.control(101);
    end

    function pause(sim)
    %PAUSE Pauses the simulation.
      sim.session.control(102);
    end

    function stop_all(sim)
    %STOP_ALL Stops all robots, including those of other clients.
      sim.session.control(190);
      sim.session.forget_commands();
    end

    function reset(sim, seed)
    %RESET Restarts at step 0; with a seed, also draws [RANDOM] anew from it.
      if nargin < 2
        seed = [];
      elseif ~isnumeric(seed) || numel(seed) ~= 1 || seed ~= round(seed) || abs(seed) > 2147483647
        coopdyn.internal.fail(2, ['a seed is a whole number of 32 bits, not ' coopdyn.internal.show(seed)]);
      elseif seed < 0
        coopdyn.internal.fail(4, sprintf('a seed is at least 0, not %d: write sim.reset(7)', seed));
      end
      sim.session.control(104, seed, [], '', 60);
      sim.session.started_anew();
    end

    function reload(sim)
    %RELOAD Reloads the scenario file from disk.
      sim.session.control(192, [], [], '', 60);
      coopdyn.internal.loaded(sim.session);
    end

    function load_scenario(sim, x)
    %LOAD_SCENARIO Loads a scenario: a name on the daemon's search path, a local file, or the text of a scenario.
      coopdyn.internal.need(nargin, 2, 'sim.load_scenario(''corridor'')');
      if ~coopdyn.internal.is_text(x) || isempty(char(x))
        coopdyn.internal.fail(3, ['a scenario is a text, not ' coopdyn.internal.show(x) ': write ' ...
          'sim.load_scenario(''corridor'')']);
      end
      x = char(x);
      if ~any(x == char(10)) && isfile(x)  % exist() finds formation.m, too
        [~, name, extension] = fileparts(x);
        x = [fileread(x) char(10) '# file: ' name extension char(10)];  % the last line tells the daemon the file's name
      end
      sim.session.control(108, [], [], x, 60);
      coopdyn.internal.loaded(sim.session);
    end

    function set_mode(sim, mode)
    %SET_MODE 'realtime', 'lockstep' or 'free'.
      coopdyn.internal.need(nargin, 2, 'sim.set_mode(''lockstep'')');
      words = {'realtime', 'lockstep', 'free'};
      if isnumeric(mode) && isscalar(mode)
        number = find((0:2) == mode, 1);
      else
        number = find(strcmp(words, mode), 1);
      end
      if isempty(number)
        coopdyn.internal.fail(4, ['there is no mode ' coopdyn.internal.show(mode) '; write one of ' strjoin(words, ', ')]);
      end
      sim.session.control(105, number - 1);
      sim.session.mode = number - 1;
    end

    function set_step(sim, s)
    %SET_STEP Length of a step, 0.0005 to 0.1 s.
      coopdyn.internal.need(nargin, 2, 'sim.set_step(0.01)');
      s = coopdyn.internal.number(s, 'the step [s]');
      if s < 0.0005 || s > 0.1
        coopdyn.internal.fail(4, sprintf('a step lasts 0.0005 to 0.1 s, not %g: write sim.set_step(0.01)', s));
      elseif abs(s - round(1e6 * s) / 1e6) > 1e-9
        coopdyn.internal.fail(4, sprintf('a step lasts whole microseconds, not %.9g s: write sim.set_step(%.6f)', s, s));
      end
      sim.session.control(106, [], s);
    end

    function set_speed(sim, x)
    %SET_SPEED Sets the real-time factor; 0 or less: no limit.
      coopdyn.internal.need(nargin, 2, 'sim.set_speed(2)');
      sim.session.control(107, [], coopdyn.internal.number(x, 'the speed factor'));
    end

    function set_participants(sim, names)
    %SET_PARTICIPANTS Sets the participants, the robots that lockstep waits for, a cell array of names; empty: those of the
    %   scenario.
      if nargin < 2
        names = '';
      end
      names = joined(names, 'sim.set_participants({''robot1'', ''robot2''})');
      sim.session.control(191, [], [], names);
    end

    function release_robot(sim, name)
    %RELEASE_ROBOT Frees a robot: closes the connection of the program that drives it, or unloads its controller.
      coopdyn.internal.need(nargin, 2, 'sim.release_robot(''robot1'')');
      sim.session.control(193, [], [], coopdyn.internal.word(name, 'the name of a robot'));
    end

    % --- status
    function s = status(sim)
    %STATUS The status of the simulation (docs/protocol.md lists the fields).
      reply = sim.session.control(100);
      s = jsondecode(reply.text);
    end

    function s = scores(sim)
    %SCORES The present scores of the run, a field for each [SCORE_n] of the scenario; NaN: undefined.
      s = struct();
      all = sim.status().scores;
      for i = 1:numel(all)
        if iscell(all); one = all{i}; else; one = all(i); end
        value = one.value;
        if isempty(value); value = NaN; end
        s.(char(one.name)) = value;
      end
    end

    function log(sim, name, value)
    %LOG Logs a number under a name: appears in sim.logged(), in --summary and in the recording (run.logged(name)).
      coopdyn.internal.need(nargin, 3, 'sim.log(''energy'', 3.5)');
      if ~coopdyn.internal.is_text(name) || ~isnumeric(value) || ~isscalar(value)
        coopdyn.internal.fail(3, 'a name and a number: write sim.log(''energy'', 3.5)');
      end
      sim.session.tell('/simulation', 197, [], double(value), char(name));
    end

    function s = logged(sim)
    %LOGGED The newest logged number of each name, a field each.
      s = struct();
      all = sim.status().logged;
      for i = 1:numel(all)
        s.(char(all(i).name)) = all(i).value;
      end
    end

    function end_run(sim, why)
    %END_RUN Ends the run because its purpose is achieved; a daemon that was started for one run exits.
      if nargin < 2; why = ''; end
      sim.session.tell('/simulation', 198, [], [], char(why));
    end

    function h = hash(sim)
    %HASH The hash of the state, 16 hexadecimal digits: equal runs give equal hashes.
      s = sim.status();
      h = char(s.hash);
    end

    function w = waiting(sim)
    %WAITING The robots that the world waits for: a 1 x n struct with robot, why, seconds.
      s = sim.status();
      w = struct('robot', {}, 'why', {}, 'seconds', {});
      for k = 1:numel(s.awaiting)
        a = s.awaiting(k);
        w(1, k) = struct('robot', a.robot, 'why', a.why, 'seconds', a.seconds);
      end
    end

    function file = snapshot(sim, file, varargin)
    %SNAPSHOT Writes a PNG picture: sim.snapshot('a.png', 'w', 640, 'h', 480, 'eye', [x y z], 'look', [x y z]).
      coopdyn.internal.need(nargin, 2, 'sim.snapshot(''a.png'')');
      options = coopdyn.internal.options(varargin, struct('w', 640, 'h', 480, 'eye', [], 'look', []));
      path = sprintf('/snapshot.png?w=%d&h=%d', coopdyn.internal.count(options.w, 'w'), ...
                     coopdyn.internal.count(options.h, 'h'));
      for word = {'eye', 'look'}
        point = options.(word{1});
        if ~isempty(point)
          if numel(point) ~= 3
            coopdyn.internal.fail(3, [word{1} ' is a point: write [x y z]']);
          end
          path = sprintf('%s&%s=%.9g,%.9g,%.9g', path, word{1}, point);
        end
      end
      file = char(file);
      coopdyn.internal.download(sim.session, path, file, 'picture', 30);
    end

    function d = describe(sim, name)
    %DESCRIBE The description of a module's commands, e.g. of '/robot1/motors', with values and units.
      coopdyn.internal.need(nargin, 2, 'sim.describe(''/robot1/motors'')');
      d = coopdyn.internal.describe(sim.session, name);
    end

    function m = modules(sim)
    %MODULES All names registered at the daemon, with their addresses: a 1 x n struct with name, host, port.
      sim.session.require_open();
      m = coopdyn.internal.ask_names(sim.session.address);
    end

    function reply = call(sim, name, command, params, data, text, varargin)
    %CALL Sends a raw message: sim.call('/robot1/motors', 'set_velocity', params, data, text, 'timeout', s) returns text,
    %   command, params, data, time, step of the reply. In lockstep, the reply to an actuator command arrives after the step.
      coopdyn.internal.need(nargin, 3, 'sim.call(''/robot1/motors'', ''set_velocity'', [], [0.2 0.5])');
      if nargin < 6, text = ''; end
      if nargin < 5, data = []; end
      if nargin < 4, params = []; end
      options = coopdyn.internal.options(varargin, struct('timeout', Inf));
      reply = coopdyn.internal.raw_call(sim.session, name, command, params, data, text, options.timeout);
    end

    function close(sim)
    %CLOSE Stops the robots of this sim and releases them. Does not wait for the step.
      if ~sim.session.closed
        sim.session.close();
      end
    end
  end
end

function text = joined(names, example)
% Joins names of robots, given as one text or a cell array of texts, by spaces; anything else is an error.
  if isa(names, 'string')
    names = cellstr(names);
  elseif isempty(names)
    names = {};
  end
  if ~iscell(names)
    names = {names};
  end
  for k = 1:numel(names)
    if ~coopdyn.internal.is_text(names{k})
      coopdyn.internal.fail(3, ['robots are named, not ' coopdyn.internal.show(names{k}) '; write e.g. ' example]);
    end
  end
  text = strjoin(cellfun(@char, reshape(names, 1, []), 'UniformOutput', false), ' ');
end

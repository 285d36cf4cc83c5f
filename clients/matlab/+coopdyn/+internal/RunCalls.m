% SPDX-License-Identifier: MIT
classdef RunCalls < coopdyn.internal.WorldCalls
%RUNCALLS Requests of a simulation to /recorder and /playback, and its saved states. Part of coopdyn.Simulation.
  methods
    % --- saved states
    function save_state(sim, name)
    %SAVE_STATE Saves the complete state of the simulation under a name; replaces an older state of that name.
      coopdyn.internal.need(nargin, 2, 'sim.save_state(''before_turn'')');
      name = coopdyn.internal.word(name, 'the name of a state');
      if isempty(regexp(name, '^[A-Za-z][A-Za-z0-9_-]{0,62}$', 'once'))
        coopdyn.internal.fail(4, ['the name of a state is a letter, then letters, digits, _ and -, at most 63: write ' ...
          'sim.save_state(''before_turn'')']);
      end
      sim.session.control(194, [], [], name);
    end

    function restore_state(sim, name)
    %RESTORE_STATE Continues from a saved state, bit for bit; 'start' is the start of the run.
      coopdyn.internal.need(nargin, 2, 'sim.restore_state(''before_turn'')');
      sim.session.control(195, [], [], coopdyn.internal.word(name, 'the name of a state'), 60);
      jumped(sim.session);
    end

    function s = saved_states(sim)
    %SAVED_STATES The states that can be restored: a 1 x n struct with name and time [s].
      reply = sim.session.control(196);
      names = strsplit(strtrim(reply.text), ' ');
      s = struct('name', {}, 'time', {});
      for k = 1:numel(reply.data) - 2
        s(1, k) = struct('name', names{k}, 'time', reply.data(k));
      end
    end

    % --- recording
    function name = record(sim, name)
    %RECORD Starts recording into the daemon's folder; returns the file's name. The default name is run-DATE-TIME. Error if the
    %   file exists.
      if nargin < 2 || isempty(name)
        name = '';
      else
        name = coopdyn.internal.run_name(name);
      end
      reply = sim.session.tell('/recorder', 121, [], [], name);
      name = reply.text;
    end

    function [name, url] = stop_recording(sim)
    %STOP_RECORDING Stops the recording and waits until its file is closed; returns its name, and its URL on the daemon's page
    %   ('': the daemon has no page).
      reply = sim.session.tell('/recorder', 122, [], [], '', 60);
      at = [strfind(reply.text, ' http://') numel(reply.text) + 1];  % the name may contain blanks
      name = reply.text(1:at(1) - 1);
      url = coopdyn.internal.url_here(sim.session.address, strtrim(reply.text(at(1):end)));
    end

    function note(sim, text)
    %NOTE Adds a note to the recording at the present time; run.events lists it.
      coopdyn.internal.need(nargin, 2, 'sim.note(''half-time'')');
      if ~coopdyn.internal.is_text(text) || isempty(char(text))
        coopdyn.internal.fail(3, ['a note is a text, not ' coopdyn.internal.show(text) ': write sim.note(''half-time'')']);
      end
      sim.session.tell('/recorder', 123, [], [], char(text));
    end

    function r = recording(sim)
    %RECORDING The recording in progress: a struct with name, begin_time, end_time [s], steps, lost, bytes; [] if there is none.
      reply = sim.session.tell('/recorder', 120);
      r = [];
      if reply.params(1)
        d = reply.data;
        r = struct('name', reply.text, 'begin_time', d(1), 'end_time', d(2), 'steps', d(3), 'lost', d(4), 'bytes', d(5));
      end
    end

    function files = recordings(sim)
    %RECORDINGS The daemon's recordings, newest first: a 1 x n struct with name, bytes, seconds (simulated), steps (nan if it
    %   cannot be read), recording, url ('' if it cannot be downloaded now).
      reply = sim.session.tell('/recorder', 124, [], [], '', 60);
      list = jsondecode(reply.text);
      files = struct('name', {}, 'bytes', {}, 'seconds', {}, 'steps', {}, 'recording', {}, 'url', {});
      for k = 1:numel(list)
        f = list(k);
        if isempty(f.seconds), f.seconds = NaN; end
        if isempty(f.steps), f.steps = NaN; end
        url = coopdyn.internal.url_here(sim.session.address, char(f.url));
        files(1, k) = struct('name', f.name, 'bytes', f.bytes, 'seconds', f.seconds, 'steps', f.steps, ...
                             'recording', logical(f.recording), 'url', url);
      end
    end

    function file = fetch_run(sim, name, file)
    %FETCH_RUN Downloads a recording: file = sim.fetch_run('lesson1') makes lesson1.mat in the current folder, which
    %   coopdyn.read_run and load read; for a file name *.run downloads the recording itself. An existing file is replaced
    %   once the download is complete.
      coopdyn.internal.need(nargin, 2, 'sim.fetch_run(''lesson1'')');
      name = regexprep(coopdyn.internal.run_name(name), '\.(run|mat)$', '');
      if nargin < 3 || isempty(file)
        file = [name '.mat'];
      end
      file = char(file);
      kind = '.mat';
      if numel(file) > 4 && strcmpi(file(end - 3:end), '.run')
        kind = '.run';
      end
      try
        coopdyn.internal.download(sim.session, ['/runs/' url_quoted([name kind])], file, 'recording', 600);
      catch cause  % Octave does not report the page's answer
        files = sim.recordings();
        at = find(strcmp({files.name}, [name '.run']), 1);
        if isempty(at)
          coopdyn.internal.fail(10, ['there is no recording ' name '.run; there are: ' coopdyn.internal.list_of({files.name})]);
        elseif files(at).recording
          coopdyn.internal.fail(5, [name '.run is being recorded: sim.stop_recording() first']);
        end
        rethrow(cause);
      end
    end

    % --- playing a recording: coopdyn play RUN
    function p = playback(sim)
    %PLAYBACK The state of the playback: a struct with begin_time, end_time, time [s], speed, playing, loop, growing (still being
    %   recorded) and file. This and the following are errors in a live run.
      reply = sim.session.tell('/playback', 130);
      d = reply.data;
      on = logical(reply.params);
      p = struct('begin_time', d(1), 'end_time', d(2), 'time', d(3), 'speed', d(4), 'playing', on(1), 'loop', on(2), ...
                 'growing', on(3), 'file', reply.text);
    end

    function seek(sim, time)
    %SEEK Shows the last step up to a simulated time [s], clamped to the recording.
      coopdyn.internal.need(nargin, 2, 'sim.seek(12.5)');
      sim.session.tell('/playback', 131, [], coopdyn.internal.number(time, 'the time [s]'));
    end

    function play(sim, speed)
    %PLAY Plays the recording, at a speed if given: -4 to 64; negative plays backwards.
      data = [];
      if nargin > 1 && ~isempty(speed)
        data = play_speed(speed);
      end
      sim.session.tell('/playback', 132, [], data);
    end

    function set_play_speed(sim, s)
    %SET_PLAY_SPEED Sets the speed of the playback: -4 to 64; negative plays backwards.
      coopdyn.internal.need(nargin, 2, 'sim.set_play_speed(2)');
      sim.session.tell('/playback', 134, [], play_speed(s));
    end

    function skip(sim, n)
    %SKIP Goes n recorded steps forward (default 1), or back if n is negative, and pauses there.
      if nargin < 2
        n = 1;
      end
      if ~isnumeric(n) || numel(n) ~= 1 || n ~= round(n) || abs(n) > 2147483647
        coopdyn.internal.fail(2, ['n must be a whole number of steps, not ' coopdyn.internal.show(n)]);
      elseif n == 0
        coopdyn.internal.fail(4, 'n is a number of steps, negative to go back, but not 0: write sim.skip(1)');
      end
      sim.session.tell('/playback', 135, n);
    end

    function set_loop(sim, on)
    %SET_LOOP Whether the playback restarts at the recording's end.
      coopdyn.internal.need(nargin, 2, 'sim.set_loop(true)');
      if ~(islogical(on) || isnumeric(on)) || numel(on) ~= 1 || ~any(double(on) == [0 1])
        coopdyn.internal.fail(3, ['on is true or false, not ' coopdyn.internal.show(on)]);
      end
      sim.session.tell('/playback', 136, double(on));
    end

    function branch(sim, time)
    %BRANCH Ends the playback: the simulation continues live from the step shown, or from a simulated time [s]. With the same
    %   inputs it repeats the recorded run bit for bit.
      data = [];
      if nargin > 1 && ~isempty(time)
        data = coopdyn.internal.number(time, 'the time [s]');
      end
      sim.session.tell('/playback', 137, [], data, '', 600);
      jumped(sim.session);
    end

    function open_run(sim, name)
    %OPEN_RUN Plays a recording of the daemon (sim.recordings() lists them). Suspends the live run until sim.close_run().
      coopdyn.internal.need(nargin, 2, 'sim.open_run(''lesson1'')');
      sim.session.tell('/playback', 138, [], [], coopdyn.internal.run_name(name), 600);
      jumped(sim.session);
    end

    function close_run(sim)
    %CLOSE_RUN Ends the playback and resumes the live run that sim.open_run() suspended.
      sim.session.tell('/playback', 139);
      jumped(sim.session);
    end
  end
end

function quoted = url_quoted(text)
% A name as a part of a URL: UTF-8, with %20 for a blank.
  bytes = reshape(double(unicode2native(text, 'UTF-8')), 1, []);
  plain = ismember(bytes, double(['a':'z' 'A':'Z' '0':'9' '-._~']));
  parts = cell(1, numel(bytes));
  parts(plain) = num2cell(char(bytes(plain)));
  parts(~plain) = arrayfun(@(b) sprintf('%%%02X', b), bytes(~plain), 'UniformOutput', false);
  quoted = [parts{:}];
end

function speed = play_speed(speed)
% Checks the speed of a playback; anything else is an error.
  speed = coopdyn.internal.number(speed, 'the speed');
  if speed < -4 || speed > 64 || speed == 0
    coopdyn.internal.fail(4, sprintf(['a recording is played at -4 to 64 times its speed (negative: backwards), not %g: write ' ...
      'sim.play(2), or sim.pause() to hold it'], speed));
  end
end

function jumped(session)
% After this sim's restore or branch: the world continues from another state, possibly of another scenario.
  session.started_anew();
  session.control(3);  % updates the mode
  driven = {};
  for group = {session.links, session.teams}
    for k = 1:numel(group{1})
      driven = [driven group{1}{k}.names]; %#ok<AGROW>
    end
  end
  if ~isempty(driven) && ~all(ismember(driven, coopdyn.internal.robot_names(session)))
    coopdyn.internal.loaded(session);
  end
end

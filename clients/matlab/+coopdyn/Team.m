% SPDX-License-Identifier: MIT
classdef Team < handle
%TEAM Drives any number of robots together through one connection. Made by sim.team.
%     team = sim.team('swarm1');
%     s = team.read();
%     for k = 1:1000
% forward [m/s], turn [rad/s] for each
%       s = team.step(V);
%     end
%     team.close();
%   While a recording is played, a team can only be read; driving it is an error.
%   names, ids, n; step, step_wheels, read, select, stop, release, close.
%   Readings are a struct with time, step, text (reports limited speeds and robots taken from the team) and the matrices
%   that select chose, one row per robot in the order of team.names: pose (x, y [m], heading [rad]), distances [m], targets
%   (distance [m], bearing [rad] of each), neighbours (id, distance, bearing of each; 0, inf, nan: no more), wheels (as
%   get_wheels), compass (heading [rad]; nan without one), support (x, y [m], angle [rad] of the load; nan without one),
%   joints (position, velocity, effort of each; nan: no more).
  properties (Dependent)
    n      % number of robots
    names  % their names, in the order of the rows
    ids    % their ids in the same order, as get_neighbours returns them
  end
  properties (Access = private)
    session
    link
  end
  methods
    function t = Team(session, link)
      t.session = session;
      t.link = link;
    end

    function n = get.n(t)
      n = numel(t.link.names);
    end

    function names = get.names(t)
      names = t.link.names;
    end

    function ids = get.ids(t)
      ids = t.link.ids;
    end

    function s = step(t, V, varargin)
    %STEP Runs one step of the world: sets each robot's forward speed [m/s] and turn rate [rad/s], waits until the step has
    %   run, in every mode, and returns the readings after it. V is n x 2, or 1 x 2 for all; without V the robots keep their
    %   speeds. In lockstep the other robots of this sim step, too, with their kept commands.
    %   team.step(V, 'timeout', 5), team.step('timeout', 5): error after 5 s.
    %   Commands for joints, and several kinds of commands in one step, have names:
    %     team.step('velocities', V, 'positions', Q)
    %     team.step('positions/legs', [0 0.6 -1.2], 'joint_velocities/head', 0.1)   % one row for all
    %   The names: velocities (forward, turn), wheels (left, right [rad/s]); positions, positions_direct,
    %   joint_velocities, efforts of all joints, or after a / of one group, with one value for each joint [rad, rad/s,
    %   N m; m, m/s, N]. nan: this joint keeps its command, or the robot has fewer joints.
      if nargin < 2
        V = [];
      elseif ~isnumeric(V) && coopdyn.internal.is_text(V)  % names
        [words, rows, varargin] = coopdyn.internal.team_commands([{V} varargin]);
        if ~isempty(words)
          s = t.go(rows, '', words, strjoin(words, ' '), varargin);
          return
        end
        V = [];
      elseif isempty(V) || ~isnumeric(V)
        t.link.settle(t.session);
        speeds(t.link, t.n, V, 'V', 'forward turn');
      end
      s = t.go(V, 'V', 'forward turn', '', varargin);
    end

    function s = step_wheels(t, W, varargin)
    %STEP_WHEELS The same with the speeds of the left and right wheel [rad/s].
      coopdyn.internal.need(nargin, 2, 'team.step_wheels([3 3])');
      if isempty(W)
        speeds(t.link, t.n, W, 'W', 'left right');
      end
      s = t.go(W, 'W', 'left right', 'wheels', varargin);
    end

    function s = read(t)
    %READ The readings of the newest step, without a step.
      s = readings(t.link, t.session, t.link.read(t.session));
    end

    function select(t, varargin)
    %SELECT Selects the readings that step and read return: 'pose', 'distances', 'targets', 'neighbours', 'wheels', 'compass',
    %   'support', 'joints', and names of sensor modules such as 'lidar': s.lidar is the module's first get command; NaN where
    %   a robot has fewer values. Default: pose and distances. Other readings cost nothing. team.select('pose', 'neighbours',
    %   4): the 4 nearest (default 8).
      known = {'pose', 'distances', 'targets', 'neighbours', 'wheels', 'compass', 'support', 'joints'};
      modules = ', and sensors'' modules by name';
      words = {};
      nearest = 8;
      for k = 1:numel(varargin)
        word = varargin{k};
        if isnumeric(word) && k > 1 && strcmp(words{end}, 'neighbours')
          nearest = coopdyn.internal.count(word, 'neighbours');
        elseif isnumeric(word)
          coopdyn.internal.fail(4, ['there is no reading ''' num2str(word) '''; there are: ' strjoin(known, ', ') modules]);
        elseif ~any(strcmp(words, char(word)))
          words{end + 1} = char(word); %#ok<AGROW>
        end
      end
      if isempty(words)
        coopdyn.internal.fail(3, ['nothing was chosen; there are: ' strjoin(known, ', ') modules]);
      end
      t.link.settle(t.session);
      try
        t.link.choose(strjoin(words, ' '), nearest);
      catch cause
        if strcmp(cause.identifier, 'coopdyn:wrong_params')
          coopdyn.internal.fail(4, [cause.message '; there are: ' strjoin(known, ', ') modules]);
        end
        rethrow(cause);
      end
    end

    function stop(t)
    %STOP Stops all robots of the team.
      t.link.own(t.session);
      t.link.ask(t.session, 114);
    end

    function release(t)
    %RELEASE Releases the robots; they keep executing their last commands.
      t.link.give_up(false);
      t.session.drop_lost_teams();
    end

    function close(t)
    %CLOSE Stops and releases the robots.
      t.link.give_up(true);
      t.session.drop_lost_teams();
    end
  end
  methods (Access = private)
    function s = go(t, V, what, columns, text, pairs)
      link = t.link;
      session = t.session;
      link.settle(session);
      limit = Inf;
      if ~isempty(pairs)
        options = coopdyn.internal.options(pairs, struct('timeout', Inf));
        limit = options.timeout;
      end
      n = numel(link.names);
      bytes = frame(link, n, V, what, columns, text);
      if ~isempty(link.playing)
        try
          link.own(session);
        catch cause
          if ~isempty(V) || ~coopdyn.internal.is_playing(cause)
            rethrow(cause);
          end
          session.step(1, limit);  % to the playback's next step
          s = t.read();
          return
        end
      end
      links = session.links;
      kept = cellfun(@(l) {l.kept}, links);
      try
        reply = session.step_team(link, bytes, limit);
      catch cause
        smaller = strcmp(cause.identifier, 'coopdyn:wrong_data') && isempty(link.lost) && numel(link.names) ~= n;
        if ~smaller || isempty(strfind(cause.message, 'no longer in the team'))
          rethrow(cause);
        end
        for k = 1:numel(links)  % the step did not run
          l = links{k};
          l.kept = kept{k};
        end
        link.settle(session);
        reply = session.step_team(link, frame(link, numel(link.names), V, what, columns, text), limit);
      end
      s = readings(link, session, reply);
    end
  end
end

function bytes = frame(link, n, V, what, columns, text)
% Encodes the request to step.
  data = [];
  if iscell(V)  % for each word of `columns`
    for k = 1:numel(V)
      V{k} = rows(link, n, V{k}, columns{k});
    end
    data = [V{:}].';
  elseif ~isempty(V)
    data = speeds(link, n, V, what, columns).';
  end
  count = numel(data);
  raw = uint8(text);
  letters = numel(raw);
  head = typecast(int32([20 + letters + 8 * count, 0, 110, letters, 0, count]), 'uint8');
  bytes = [head raw typecast(reshape(data, 1, count), 'uint8')];  % row by row
end

function V = rows(link, n, V, what)
% n rows of doubles, finite or nan.
  if ~isnumeric(V) || ~isreal(V) || ~ismatrix(V) || isempty(V)
    coopdyn.internal.fail(3, [what ' is a matrix of numbers, a row for each robot, or one row for all']);
  end
  if ~any(size(V, 1) == [1 n])
    say_who_is_gone(link, n, what);
    coopdyn.internal.fail(3, sprintf(['%s is %d x %d, the team has %d robots; write a row for each robot, or one ' ...
      'row for all'], what, size(V, 1), size(V, 2), n));
  end
  bad = find(any(isinf(V), 2), 1);
  if ~isempty(bad)
    coopdyn.internal.fail(4, sprintf('row %d of %s must be finite, or nan: this joint keeps its command', bad, what));
  end
  V = double(V);
  if size(V, 1) < n
    V = repmat(V, n, 1);
  end
end

function V = speeds(link, n, V, what, columns)
% n x 2 finite doubles.
  if ~isnumeric(V) || ~isreal(V) || ~ismatrix(V)
    coopdyn.internal.fail(3, sprintf('%s is a matrix of numbers, %d x 2: a row [%s] for each robot', what, n, columns));
  end
  given = size(V, 1);
  fits = given == n || given == 1;
  if ~fits
    say_who_is_gone(link, n, what);
  end
  if ~fits || size(V, 2) ~= 2
    coopdyn.internal.fail(3, sprintf(['%s is %d x %d, the team has %d robots; write %d x 2, one row [%s] for each ' ...
      'robot, or one row for all'], what, given, size(V, 2), n, n, columns));
  end
  finite = isfinite(V);
  if ~all(finite(:))
    bad = find(~all(finite, 2), 1);
    whose = what;
    if given == n
      whose = sprintf('row %d of %s (%s)', bad, what, link.names{bad});
    end
    coopdyn.internal.fail(4, sprintf('%s must be finite, not %g, %g', whose, V(bad, 1), V(bad, 2)));
  end
  V = double(V);
  if given < n
    V = repmat(V, n, 1);
  end
end

function say_who_is_gone(link, n, what)
% Says why the rows no longer fit.
  gone = link.gone;
  if isempty(gone)
    return
  end
  more = '';
  if numel(gone) > 4
    more = sprintf(' and %d more', numel(gone) - 4);
  end
  coopdyn.internal.fail(3, sprintf(['%s has lost %s%s: %s must have %d rows now, in the order of team.names, or ' ...
    'one row for all'], link.label, strjoin(gone(1:min(end, 4)), ', '), more, what, n));
end

function s = readings(link, session, reply)
% Decodes the matrices of a reply. Queries the columns again if robots or targets were added or removed.
  n = reply.params(end - 1);
  m = reply.params(end);
  columns = link.columns;
  if n ~= numel(link.names) || m ~= sum(columns)
    link.refresh(session);
    columns = link.columns;
    if n ~= numel(link.names) || m ~= sum(columns)
      s = readings(link, session, link.read(session));  % the team has changed again meanwhile
      return
    end
  end
  data = reply.data;
  count = n * m;
  parts = mat2cell(reshape(data(1:count), m, n).', n, columns);
  s = cell2struct([{data(count + 1), data(count + 2), reply.text} parts], [{'time', 'step', 'text'} link.readings], 2);
end

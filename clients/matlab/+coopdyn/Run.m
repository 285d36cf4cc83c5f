% SPDX-License-Identifier: MIT
classdef Run
%RUN A recorded run, made by coopdyn.read_run.
%     run = coopdyn.read_run('lesson1.mat');
%     p = run.pose('robot1');  plot(p(:, 1), p(:, 2))    % a path
%   k is the number of recorded moments; the first is the state at the recording's start. Values that did not exist or were
%   not recorded at a moment are nan. Methods: pose, pose_3d, reading, joints, commands, score, scores, logged.
  properties (SetAccess = private)
    file      % the file's name
    info      % struct: properties of the whole run, version and seed
    scenario  % the text of the scenario
    names     % of all robots, 1 x n cell
    time      % simulated times [s], k x 1
    steps     % numbers of the steps, k x 1
    hash      % of the exact state at each moment, 16 hexadecimal digits, k x 1 cell: equal runs have equal hashes
    events    % all events in order: 1 x n struct with step, time [s], level, text; notes have the level 'note'
  end
  properties (Access = private)
    robots
    objects
    values  % of the scores: struct array with name, unit, value
  end
  methods
    function run = Run(s)
    % s: the struct that coopdyn export --to mat writes.
      run.file = s.file;
      run.info = struct('version', s.version, 'seed', s.seed);
      run.scenario = s.scenario;
      run.names = reshape(s.names, 1, []);
      run.time = s.time(:);
      run.steps = s.step(:);
      run.hash = cellstr(s.hash);
      run.robots = s.robots;
      run.objects = s.objects;
      run.values = struct('name', {}, 'unit', {}, 'value', {});
      if isfield(s, 'scores'); run.values = s.scores; end  % older files have none
      run.events = struct('step', {}, 'time', {}, 'level', {}, 'text', {});
      for k = 1:numel(s.events)
        e = s.events(k);
        run.events(1, k) = struct('step', e.step, 'time', e.time_s, 'level', e.level, 'text', e.text);
      end
    end

    function p = pose(run, name)
    %POSE x, y [m] and heading [rad] of a robot or a moving object, k x 3.
      coopdyn.internal.need(nargin, 2, 'run.pose(''robot1'')');
      i = find_name(run.robots, name);
      if i > 0
        p = run.robots(i).pose;
        return
      end
      q = run.pose_3d(name);
      w = q(:, 4);
      x = q(:, 5);
      y = q(:, 6);
      z = q(:, 7);
      p = [q(:, 1:2), atan2(2 * (w .* z + x .* y), 1 - 2 * (y .* y + z .* z))];
    end

    function p = score(run, name)
    %SCORE Time [s] and value of a score, k x 2; nan: undefined.
      coopdyn.internal.need(nargin, 2, 'run.score(''distance'')');
      i = find_name(run.values, name);
      if i == 0
        text = [run.file ' has no score ' char(name)];
        if ~isempty(run.values); text = [text '; there are ' strjoin({run.values.name}, ', ')]; end
        coopdyn.internal.fail(10, text);
      end
      p = [run.time, run.values(i).value(:)];
    end

    function s = scores(run)
    %SCORES The scores at the last moment, a field for each of the scenario's [SCORE_n].
      s = struct();
      for i = 1:numel(run.values)
        s.(run.values(i).name) = run.values(i).value(end);
      end
    end

    function p = logged(run, name)
    %LOGGED Time [s] and value of each number logged under a name, n x 2.
      coopdyn.internal.need(nargin, 2, 'run.logged(''energy'')');
      p = zeros(0, 2);
      others = {};
      for k = 1:numel(run.events)
        if ~strcmp(run.events(k).level, 'log'); continue; end
        words = strsplit(run.events(k).text, ' ');
        others{end + 1} = words{1}; %#ok<AGROW>
        if strcmp(words{1}, name); p(end + 1, :) = [run.events(k).time, str2double(words{2})]; end %#ok<AGROW>
      end
      if isempty(p)
        text = [run.file ' has no numbers logged under ' char(name)];
        if ~isempty(others); text = [text '; there are ' strjoin(unique(others), ', ')]; end
        coopdyn.internal.fail(10, text);
      end
    end

    function p = pose_3d(run, name)
    %POSE_3D x, y, z [m] and quaternion w, x, y, z in the world, k x 7.
      coopdyn.internal.need(nargin, 2, 'run.pose_3d(''robot1'')');
      i = find_name(run.robots, name);
      if i > 0
        p = run.robots(i).pose_3d;
        return
      end
      i = find_name(run.objects, name);
      if i == 0
        known = run.names;
        if ~isempty(run.objects)
          known = [known reshape({run.objects.name}, 1, [])];
        end
        coopdyn.internal.fail(10, ['there is no ''' char(name) ''' in ' run.file '; ' ...
          coopdyn.internal.nearest(char(name), known) 'there are: ' coopdyn.internal.list_of(known)]);
      end
      p = run.objects(i).pose_3d;
    end

    function r = reading(run, name, what)
    %READING A robot's readings, one row per moment: 'distances' [m], right to left, inf = nothing there; 'targets': distance
    %   [m] and bearing [rad] of each, nan = not seen; 'channels': positions [rad], not wrapped, then velocities [rad/s]
    %   (sliding joints: [m], [m/s]) of the m channels in the order of run.joints(name), k x 2m.
      coopdyn.internal.need(nargin, 3, 'run.reading(''robot1'', ''distances'')');
      known = {'distances', 'targets', 'channels'};
      what = char(what);
      if ~any(strcmp(known, what))
        coopdyn.internal.fail(4, ['there is no reading ''' what '''; there are: ' strjoin(known, ', ')]);
      end
      robot = run.robot(name);
      r = robot.(what);
      if isempty(r) && size(r, 1) ~= numel(run.time)
        coopdyn.internal.fail(5, [what ' were not recorded in ' run.file '; record with --record-what all']);
      end
    end

    function j = joints(run, name)
    %JOINTS The names of the joints that a robot's m channels drive, 1 x m cell: the columns of its channels and commands.
      coopdyn.internal.need(nargin, 2, 'run.joints(''robot1'')');
      robot = run.robot(name);
      j = reshape(robot.joints, 1, []);
    end

    function c = commands(run, name)
    %COMMANDS The set-points of a robot, one row per change: the step of the change, time [s], the set-points of its m channels,
    %   and their control modes: 1 position [rad], 3 velocity [rad/s], 4 effort [N m] (0 idle, 2 direct), so 2 + 2m columns. The
    %   first row is in force at the recording's start. Empty if a loaded controller drove the robot and its commands were not
    %   recorded.
      coopdyn.internal.need(nargin, 2, 'run.commands(''robot1'')');
      robot = run.robot(name);
      c = robot.commands;
    end
  end
  methods (Access = private)
    function r = robot(run, name)
      i = find_name(run.robots, name);
      if i == 0
        coopdyn.internal.fail(10, [char(name) ' is no robot of ' run.file '; there are: ' coopdyn.internal.list_of(run.names)]);
      end
      r = run.robots(i);
    end
  end
end

function i = find_name(list, name)
% The index of a name; 0 if unknown.
  i = 0;
  if ~isempty(list)
    found = find(strcmp({list.name}, char(name)), 1);
    if ~isempty(found)
      i = found;
    end
  end
end

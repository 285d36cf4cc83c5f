% SPDX-License-Identifier: MIT
classdef Robot < coopdyn.internal.SensorCalls
%ROBOT One robot of a simulation. Readings always belong to the newest step.
%   Commands: set_velocity, set_wheel_speeds, stop, send_message; joints: its arm or other groups of joints; muscles,
%   thrusters, channel: if the robot has them. Readings:
%   get_pose, get_pose_3d, get_distances, get_geometry, get_targets, get_target, get_robots, get_neighbours, get_messages,
%   get_compass, get_support, get_wheels, get_limits; sense: all of one step at once. Of robots with such sensors: get_imu,
%   get_wrench, get_scan, get_contacts, get_bumper, get_sonar, get_infrared, get_light, get_battery, get_odometry; of their
%   cameras: get_image, get_jpeg, get_depth, get_segmentation, get_camera.
%   Units: m, rad, m/s, rad/s; bearings 0 ahead, left positive. Rows are 1 x n.
  properties (SetAccess = private)
    name
  end
  methods
    function r = Robot(session, link)
      r.session = session;
      r.link = link;
      r.name = link.robot;
    end

    % --- commands
    function set_velocity(r, v, w)
    %SET_VELOCITY Forward speed v [m/s] and turn rate w [rad/s], left is positive: r.set_velocity(0.2, 0.5), or as one
    %   row, r.set_velocity([0.2 0.5]). Beyond the limits both are scaled.
      if nargin < 3
        if nargin < 2 || numel(v) ~= 2
          coopdyn.internal.fail(3, ['set_velocity takes v [m/s] and w [rad/s]: write r.set_velocity(0.2, 0.5) or ' ...
                                    'r.set_velocity([0.2 0.5])']);
        end
        w = v(2);
        v = v(1);
      end
      if isa(v, 'double') && isa(w, 'double') && numel(v) == 1 && numel(w) == 1 && isreal(v) && isreal(w) ...
          && isfinite(v) && isfinite(w)
        command = [v w];
      else
        command = [coopdyn.internal.number(v, 'v [m/s]') coopdyn.internal.number(w, 'w [rad/s]')];
      end
      link = r.link;
      if link.drives && r.session.mode == 1 && isempty(link.kept) && strcmp(link.actuator, 'motors')
        link.kept = {11, command, []};  % lockstep: the same as Link.command
      else
        link.command(r.session, 11, command);
      end
    end

    function set_wheel_speeds(r, left, right)
    %SET_WHEEL_SPEEDS Speeds of the left and right wheel [rad/s]: r.set_wheel_speeds(2, 3) or r.set_wheel_speeds([2 3]).
      if nargin < 3
        if nargin < 2 || numel(left) ~= 2
          coopdyn.internal.fail(3, ['set_wheel_speeds takes left and right [rad/s]: write r.set_wheel_speeds(2, 3) or ' ...
                                    'r.set_wheel_speeds([2 3])']);
        end
        right = left(2);
        left = left(1);
      end
      left = coopdyn.internal.number(left, 'left [rad/s]');
      right = coopdyn.internal.number(right, 'right [rad/s]');
      r.link.command(r.session, 10, [left right]);
    end

    function send_message(r, values)
    %SEND_MESSAGE Broadcasts one to eight numbers with the next step to the robots within range. The last message before the
    %   step wins. For robots with a module neighbours.
      coopdyn.internal.need(nargin, 2, 'r.send_message([1 0.5])');
      if ~isnumeric(values) || isempty(values) || numel(values) > 8
        coopdyn.internal.fail(3, ['a message is a row of 1 to 8 numbers, not ' coopdyn.internal.show(values)]);
      end
      for k = 1:numel(values)
        coopdyn.internal.number(values(k), 'a value of a message');
      end
      if r.session.watch
        coopdyn.internal.fail(5, 'this sim only watches; connect without ''watch'' to drive');
      end
      r.session.read(r.link, 'neighbours', 201, [], '', double(values));
    end

    function stop(r)
    %STOP Stops both wheels; like the other commands, in lockstep with the next sim.step().
      r.link.command(r.session, 14, []);
    end

    % --- readings
    function p = get_pose(r)
    %GET_POSE x, y [m], heading [rad], forward [m/s], turn [rad/s], in the world frame.
      p = r.get('pose', 40, [], '');
    end

    function p = get_pose_3d(r)
    %GET_POSE_3D Position [m], quaternion and both velocities [m/s, rad/s] in the world frame (ground truth).
      p = r.get('pose', 41, [], '');
    end

    function heading = get_compass(r, module)
    %GET_COMPASS The robot's heading [rad]: 0 along the world's x, left positive. For robots with a module compass; pass the
    %   module's name for another compass: r.get_compass('left_compass').
      if nargin < 2
        module = 'compass';
      end
      heading = r.get(char(module), 300, [], '');
    end

    function s = get_support(r, module)
    %GET_SUPPORT x, y [m] and angle [rad] by which the load has displaced its support, in the robot's frame. For robots with a
    %   module support.
      if nargin < 2
        module = 'support';
      end
      s = r.get(char(module), 280, [], '');
    end

    function d = get_distances(r)
    %GET_DISTANCES One range per sensor [m], right to left, from the surface of the robot; inf = nothing there.
      d = r.get('distance', 20, [], '');
    end

    function g = get_geometry(r)
    %GET_GEOMETRY bearing [rad], opening [rad] and max_range [m] of each distance sensor, right to left.
      g = r.get('distance', 21, [], '');
    end

    function t = get_targets(r)
    %GET_TARGETS id, colour, distance [m] and bearing [rad] of every target, a 1 x n struct.
      t = r.get('target', 30, [], '');
    end

    function t = get_target(r, x)
    %GET_TARGET distance [m] and bearing [rad] of the nearest target of a colour, or of the target with an id.
      coopdyn.internal.need(nargin, 2, 'r.get_target(''red'') or r.get_target(1)');
      if isnumeric(x)
        t = r.get('target', 31, coopdyn.internal.count(x, 'the id of a target'), '');
      elseif coopdyn.internal.is_text(x) && ~isempty(char(x))
        t = r.get('target', 31, [], char(x));
      else
        coopdyn.internal.fail(3, ['a target is a colour or an id, not ' coopdyn.internal.show(x) '; write ' ...
          'r.get_target(''red'') or r.get_target(1)']);
      end
    end

    function o = get_robots(r)
    %GET_ROBOTS id, name, distance [m] and bearing [rad] of every other robot, a 1 x n struct.
      o = r.get('target', 32, [], '');
    end

    function n = get_neighbours(r)
    %GET_NEIGHBOURS id, name, distance [m] and bearing [rad] of every robot within range, a 1 x n struct. For robots with a
    %   module neighbours.
      n = r.get('neighbours', 200, [], '');
    end

    function m = get_messages(r)
    %GET_MESSAGES The messages received in this step, a 1 x n struct: id, distance [m] and bearing [rad] of the sender, and its
    %   values. For robots with a module neighbours.
      m = r.get('neighbours', 202, [], '');
    end

    function w = get_wheels(r)
    %GET_WHEELS left_angle, right_angle [rad], left_speed, right_speed [rad/s].
      w = r.get('motors', 12, [], '');
    end

    function l = get_limits(r)
    %GET_LIMITS max_wheel_speed [rad/s], wheel_radius and track [m].
      l = r.get('motors', 13, [], '');
    end

    function s = sense(r, x)
    %SENSE All readings of one step in one round trip: time, step, distances, targets, target, pose, wheels, compass,
    %   support, joints; imu, wrench, scan, contacts (id -1, no name), sonar, infrared, light, battery, odometry, each of the
    %   first sensor of its type; read others by name: r.get_scan('rear_lidar').
    %   s = r.sense('red'): s.target is the nearest target of that colour (or with that id); error if there is none.
    %   In lockstep, directly after sim.step(), it needs no round trip, because the step's reply carried the readings.
      link = r.link;
      link.require_here();
      attached = link.attached;
      if isempty(attached)
        r.attach();
        attached = link.attached;
      end
      reply = link.carried;
      if isempty(reply)
        reply = r.ask_attached();
      else
        link.carried = [];
      end
      s = coopdyn.internal.attached_readings(attached, reply);
      if ~isempty(s.scan)
        s.scan = r.scan('lidar', s.scan);
      end
      seen = s.targets;
      % Ids and colours change only with a reset, load or edit: query them again if the step did not advance, if their
      % number changed, or after half a second.
      labels = link.labels;
      if ~isempty(seen) && (s.step <= labels.step || 2 * numel(labels.ids) ~= numel(seen) || toc(labels.when) > 0.5)
        t = r.get_targets();
        labels.ids = {t.id};
        labels.colours = {t.colour};
      end
      labels.step = s.step;
      labels.when = tic;
      link.labels = labels;
      if isempty(seen)
        s.targets = coopdyn.internal.sightings([], 'colour', {}, []);
      else
        s.targets = struct('id', labels.ids, 'colour', labels.colours, 'distance', num2cell(seen(1:2:end)), ...
                           'bearing', num2cell(seen(2:2:end)));
      end
      if nargin > 1
        s.target = coopdyn.internal.choose_target(s.targets, x);
      end
    end

    function j = joints(r, name)
    %JOINTS A group of joints, a coopdyn.Joints: a <coopdyn:group> of the robot's model, or 'joints' if the model names none.
    %   Without a name, the only group.
      if nargin < 2
        name = '';
      end
      j = coopdyn.Joints(r.session, coopdyn.internal.group(r.session, r.link, char(name)));
    end

    function m = muscles(r)
    %MUSCLES The robot's muscles, a coopdyn.Muscles.
      m = coopdyn.Muscles(r.session, coopdyn.internal.actuator(r.session, r.link, 'muscles'));
    end

    function t = thrusters(r)
    %THRUSTERS The robot's thrusters, a coopdyn.Thrusters.
      t = coopdyn.Thrusters(r.session, coopdyn.internal.actuator(r.session, r.link, 'thrusters'));
    end

    function c = channel(r)
    %CHANNEL The robot's channel, a coopdyn.Channel: exchanges all motors and values that the model maps. From then on only the
    %   channel drives the robot: commands to its wheels, joints, muscles or thrusters are errors.
      c = coopdyn.Channel(r.session, coopdyn.internal.actuator(r.session, r.link, 'channel'));
    end

    % --- pushed readings
    function subscribe(r, module, n)
    %SUBSCRIBE Subscribes to the first reading of 'distance', 'target', 'pose' or 'motors' every n steps (default 1); next
    %   returns them. n = 0 unsubscribes. Up to 64 readings are queued; then the oldest is dropped.
      coopdyn.internal.need(nargin, 2, 'r.subscribe(''distance'')');
      if nargin < 3
        n = 1;
      end
      module = coopdyn.internal.word(module, 'a module, as ''distance'',');
      session = r.session;
      session.require_open();
      if isfield(r.link.pushers, module)
        old = r.link.pushers.(module);
        old.close();
        r.link.pushers = rmfield(r.link.pushers, module);
      end
      if isequal(n, 0)
        return
      end
      n = coopdyn.internal.count(n, 'n');
      c = coopdyn.internal.Connection(session.address, r.link.path(module));
      try
        c.open();
      catch cause
        if ~strcmp(cause.identifier, 'coopdyn:no_such_name') || ~r.link.find_again(session, module, c)
          rethrow(cause);
        end
        c.open();
      end
      c.request(4, n, []);
      r.link.pushers.(module) = c;
    end

    function u = next(r, varargin)
    %NEXT Waits for the next pushed reading: module, time, step, value (the result of the get command), text.
    %   r.next() of any subscription, r.next('pose') of one module; r.next('timeout', 2) waits at most 2 s.
    %   If robots hold the world up for more than 2 s, reports them once.
      chosen = fieldnames(r.link.pushers)';
      if mod(numel(varargin), 2) == 1
        chosen = {char(varargin{1})};
        varargin(1) = [];
      end
      options = coopdyn.internal.options(varargin, struct('timeout', Inf));
      if isempty(chosen) || ~all(isfield(r.link.pushers, chosen))
        coopdyn.internal.fail(5, 'nothing is subscribed to; write r.subscribe(''distance'') first');
      end
      wait = coopdyn.internal.Wait(r.session, options.timeout, ['no reading of ' strjoin(chosen, ', ')], true);
      while true
        for k = 1:numel(chosen)
          c = r.link.pushers.(chosen{k});
          if isempty(c.pushes)
            try
              c.poll(numel(chosen) == 1);
            catch cause
              r.link.pushers = rmfield(r.link.pushers, chosen{k});
              if ~any(strcmp(coopdyn.internal.robot_names(r.session), r.name))
                r.session.new_world('load');
              end
              rethrow(cause);
            end
          end
          if ~isempty(c.pushes)
            pushed = c.pushes{1};
            c.pushes(1) = [];
            r.session.note(pushed);
            data = pushed.data;
            value = coopdyn.internal.value(-pushed.command, pushed.params, pushed.text, data(1:end - 2));
            u = struct('module', chosen{k}, 'time', data(end - 1), 'step', data(end), 'value', value, ...
                       'text', pushed.text);
            return
          end
        end
        wait.rest();
      end
    end

    function reply = call(r, module, command, params, data, text, varargin)
    %CALL Sends a raw message to one of this robot's modules, e.g. r.call('motors', 'set_velocity', [], [0.2 0]).
      coopdyn.internal.need(nargin, 3, 'r.call(''motors'', ''set_velocity'', [], [0.2 0])');
      if nargin < 6, text = ''; end
      if nargin < 5, data = []; end
      if nargin < 4, params = []; end
      options = coopdyn.internal.options(varargin, struct('timeout', Inf));
      r.session.require_open();
      if isempty(fieldnames(r.link.modules))
        r.link.modules = coopdyn.internal.modules_of(r.session, r.name);
      end
      reply = coopdyn.internal.raw_call(r.session, r.link.path(char(module)), command, params, data, text, options.timeout);
    end
  end
  methods (Access = private)
    function attach(r)
      link = r.link;
      link.modules = coopdyn.internal.modules_of(r.session, r.name);
      readable = {'motors', 'distance', 'target', 'pose', 'compass', 'support', 'imu', 'wrench', 'lidar', 'contact', ...
                  'sonar', 'infrared', 'light', 'battery', 'odometry'};
      readable = readable(isfield(link.modules, readable));
      readable = [readable strcat('joints/', coopdyn.internal.groups_of(r.session, r.name))];
      if isempty(readable)
        coopdyn.internal.fail(10, [r.name ' has no readings']);
      end
      c = r.attached_connection(readable);
      link.attached = readable;
      try
        link.attach(c);
      catch cause
        link.attached = {};
        rethrow(cause);
      end
      link.carried = [];
    end

    function c = attached_connection(r, readable)
      link = r.link;
      session = r.session;
      if ~isempty(link.motors)
        link.settle(session);
        c = link.motors;
        return
      end
      c = session.reader(link, 'attached', readable{1});
      if ~c.alive()
        c.open();
        if ~isempty(link.attached)
          link.attach(c);
        end
      end
    end

    function reply = ask_attached(r)
      link = r.link;
      r.session.require_open();
      c = r.attached_connection(link.attached);
      since = r.session.reached;
      try
        reply = c.request(3, [], []);
      catch cause
        if isempty(link.motors)
          rethrow(cause);
        end
        coopdyn.internal.lose(r.session, link, cause);
      end
      r.session.note(reply);
      r.session.go_on(reply.data(end), since);
    end
  end
end

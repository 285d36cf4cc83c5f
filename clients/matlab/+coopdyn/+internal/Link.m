% SPDX-License-Identifier: MIT
classdef Link < handle
%LINK The connections to an actuator module of a robot, and the command kept for the next step. A robot's first link, its
%  motors if it has any, also owns the robot's other connections.
  properties
    robot
    label              % in errors
    names              % of the robots that the link drives
    is_team = false
    in_team = false    % a team of this sim drives it; it can only be read
    by_channel = false % the robot's channel drives it
    actuator = 'motors'  % or the name of a module
    type = 'motors'      % type of `actuator`
    last = {}            % {command, data} to send when the sim closes, instead of stop or hold
    others = {}        % the robot's further actuators
    motors = []        % the connection for commands; [] = no actuator
    readers = struct() % connections for readings, by module
    pushers = struct() % connections for pushed readings, by module
    modules = struct() % names of modules by type; queried when first needed
    drives = false     % open, claimed, not lost, and commanded before
    commanded = false  % by this program, ever
    unclaimed = false  % read-only: the last claim failed, in a playback or because
    another = false    % another program had it; then claimed again only by a command
    beside = false     % no participant in lockstep: steps do not wait for its reply
    kept = []          % {command, data, joints or the like}, for the next step
    sent = []          % the same, of a command with pending reply
    sent_at = 0        % newest step when `sent` was sent
    commanded_at = -1       % newest step when a command was answered immediately: it runs in a later step
    unstepped = 0      % commands since the last step
    unstepped_since = 0  % the step of the first of them
    lost = ''          % why this sim no longer drives it
    lost_code = 6
    attached = {}      % types of modules, in the order of their readings
    carried = []       % readings in the reply to the last step
    labels = struct('step', -1, 'when', uint64(0), 'ids', {{}}, 'colours', {{}})  % ids and colours of the targets
    scans = struct()   % replies to get_scan_geometry, by module
  end
  methods
    function link = Link(address, robot, drives)
      link.robot = robot;
      link.label = robot;
      link.names = {robot};
      link.motors = coopdyn.internal.Connection(address, ['/' robot '/motors'], drives);
    end

    function drive_part(link, address, name, type, drives)
    % True if its actuator is a group of joints, muscles, thrusters or a channel.
      link.actuator = name;
      link.type = type;
      link.label = [link.robot '/' name];
      link.motors = coopdyn.internal.Connection(address, ['/' link.robot '/' name], drives);
    end

    function yes = has_parts(link)
    % True if a command lasts one step and names the parts.
      yes = ~strcmp(link.type, 'motors');
    end

    function p = path(link, module)
    % The path of the module of this type or name; joints/NAME is a group of joints.
      if strncmp(module, 'joints/', 7)
        module = module(8:end);
      elseif isfield(link.modules, module)
        module = link.modules.(module);
      end
      p = ['/' link.robot '/' module];
    end

    function yes = find_again(link, session, module, c)
    % After coopdyn:no_such_name: looks up the module's name by its type, as a model may call its motors legs. True if c has
    % another module now.
      link.modules = coopdyn.internal.modules_of(session, link.robot);
      before = c.module;
      c.module = link.path(module);
      yes = ~strcmp(c.module, before);
    end

    function attach(link, c)
    % Attaches the readings of these modules to every reply to get_time on c.
      names = cellfun(@(m) link.path(m), link.attached, 'UniformOutput', false);
      c.request(9, [], [], strjoin(regexprep(names, '^.*/', ''), ' '));
    end

    function claim(link, session)
      link.unclaimed = true;
      try
        link.motors.request(7, [], []);
      catch cause
        if strcmp(cause.identifier, 'coopdyn:owned')
          if session.has_team_with(link.robot)
            coopdyn.internal.fail(5, [link.robot ' is driven by its team']);
          end
          coopdyn.internal.fail(6, [link.robot ' cannot be driven: ' cause.message ...
            '; to watch only: coopdyn.connect(''watch'', true)']);
        end
        rethrow(cause);
      end
      link.unclaimed = false;
      link.another = false;
      link.drives = link.commanded;
      session.note(link.motors.request(3, [], []));  % a branch may have changed the mode
    end

    function yes = takes_part(link, session)
    % True if the robot steps with this sim. Claims an unclaimed robot if it is free.
      yes = false;
      if isempty(link.motors)
        return
      end
      link.settle(session);
      if link.unclaimed && ~link.another
        try
          link.claim(session);
        catch cause
          if ~any(strcmp(cause.identifier, {'coopdyn:owned', 'coopdyn:not_possible'}))
            rethrow(cause);
          end
          link.another = ~coopdyn.internal.is_playing(cause);
        end
      end
      yes = ~link.unclaimed;
    end

    function let_go(link, session)
    % Releases a robot for a team if this program never commanded it.
      link.settle(session);
      link.motors.request(8, [], []);
      link.forget_commands();
      link.unclaimed = true;
      link.another = true;
      link.drives = false;
    end

    function open(link, session)
    % (Re)opens the connection for commands: hello takes the module back, claim claims it.
      link.sent = [];
      link.carried = [];
      link.drives = false;
      c = link.motors;
      c.open();
      try
        if ~session.watch
          try
            link.claim(session);
          catch cause
            if ~strcmp(cause.identifier, 'coopdyn:not_possible') && ~link.another  % a recording is played; reading still works
              rethrow(cause);
            end
          end
        end
        if ~isempty(link.attached)
          link.attach(c);
        end
        if session.watch || link.unclaimed
          session.note(c.request(3, [], []));
        end
      catch cause
        link.drives = false;
        c.close();
        rethrow(cause);
      end
    end

    function settle(link, session)
    % Makes the connection for commands ready for a request: reopens it if it broke, receives an overdue reply.
      if ~isempty(link.lost)
        coopdyn.internal.fail(link.lost_code, link.lost);
      end
      c = link.motors;
      if isempty(c.socket) || (~c.idle && isempty(link.sent))  % interrupted, or not reopened
        link.open(session);
      end
      if isempty(link.sent) || link.await_command(session, 0.08)
        return
      end
      % No reply: in lockstep it arrives only after the step. Withdraw the command, and keep it.
      reply = session.control(3);
      if reply.params(1) == 1
        if isempty(link.kept)
          link.kept = link.sent;
        end
        link.open(session);
      else
        reply = c.receive(10);
        link.sent = [];
        coopdyn.internal.check_reply(reply, '');
        session.note(reply);
      end
    end

    function yes = is_free(link, session)
    % True if no reply to a command is pending.
      yes = isempty(link.sent) || link.await_command(session, 0);
    end

    function came = await_command(link, session, wait_s)
    % Waits briefly for the reply to a command.
      c = link.motors;
      started = [];
      while true
        try
          reply = c.poll(isempty(started));
        catch cause
          coopdyn.internal.lose(session, link, cause);
        end
        came = ~isempty(reply);
        if came
          link.sent = [];
          coopdyn.internal.check_reply(reply, '');
          session.note(reply);
          session.go_on(reply.data(end), link.sent_at);
          return
        end
        if wait_s == 0 || ~isempty(started) && toc(started) > wait_s
          return
        elseif isempty(started)
          started = tic;
        end
        pause(0.001);
      end
    end

    function command(link, session, number, data, joints)
    % In lockstep keeps an actuator command, otherwise sends it.
      if nargin < 5, joints = []; end
      session.require_open();
      if session.watch
        coopdyn.internal.fail(5, 'this sim only watches; connect without ''watch'' to drive');
      end
      if isempty(link.motors) || link.has_parts() == isempty(joints)
        if link.in_team
          coopdyn.internal.fail(5, [link.robot ' is driven by its team']);
        elseif link.by_channel
          coopdyn.internal.fail(5, [link.robot ' is driven through its channel']);
        end
        coopdyn.internal.fail(5, [link.robot ' has no motors']);
      end
      if ~isempty(link.lost)
        coopdyn.internal.fail(link.lost_code, link.lost);
      end
      if session.mode ~= 1 || link.unclaimed
        link.settle(session);
      end
      if link.unclaimed
        link.claim(session);  % a branch may have ended the playback
      end
      link.commanded = true;
      link.drives = true;
      if session.mode == 1
        if ~isempty(link.kept)
          link.count_unstepped(session);
        end
        link.kept = coopdyn.internal.merged(link.kept, {number, data, joints}, link.label);
        return
      end
      link.kept = [];
      link.count_unstepped(session);
      link.sent_at = session.reached;
      try
        link.motors.send(number, coopdyn.internal.encode(number, joints, data));
      catch cause
        coopdyn.internal.lose(session, link, cause);
      end
      link.sent = {number, data, joints};
      link.await_command(session, 0.08);
      link.commanded_at = session.newest(2);
    end

    function send_step(link, session)
    % Sends a command without waiting for the reply.
      link.sent_at = session.reached;
      [number, bytes] = link.frame(1);
      try
        link.motors.send(number, bytes);
      catch cause
        coopdyn.internal.lose(session, link, cause);
      end
    end

    function [number, bytes] = frame(link, n)
    % The request that makes n steps: the kept command, or ready.
      link.unstepped = 0;
      link.carried = [];
      kept = link.kept;
      if isempty(kept)
        link.sent = {2, [], []};
        number = 2;
        bytes = typecast(int32([24 0 2 0 1 0 n]), 'uint8');
        return
      end
      link.kept = [];
      link.sent = kept;
      number = kept{1};
      data = kept{2};
      if ~isempty(kept{3})
        bytes = coopdyn.internal.encode(number, kept{3}, data);
        return
      end
      k = numel(data);
      bytes = typecast(int32([24 + 8 * k, 0, number, 0, 1, k, n]), 'uint8');
      if k > 0
        bytes = [bytes typecast(data, 'uint8')];
      end
    end

    function step = stepped(link, session, reply)
    % Stores the reply to a step; returns its step.
      link.sent = [];
      if reply.error ~= 0
        coopdyn.internal.check_reply(reply, [link.robot ': ']);
      end
      newest = reply.data(end - 1:end);
      step = newest(2);
      session.newest = newest;
      session.mode = reply.params(1);
      if session.mode == 1
        link.carried = reply;
      end
    end

    function count_unstepped(link, session)
    % Reports once that the program never calls sim.step(), unless time passes in another way, e.g. by pause.
      link.unstepped = link.unstepped + 1;
      if link.unstepped == 1
        link.unstepped_since = session.newest(2);
      end
      if link.unstepped < 200 || session.told_to_step
        return
      end
      link.unstepped = 0;
      why = 'nothing moves';
      if session.mode ~= 1
        if 2 * (session.newest(2) - link.unstepped_since) >= 200
          return
        end
        why = 'your loop runs faster than time';
      end
      session.told_to_step = true;
      fprintf(2, 'coopdyn: 200 commands to %s without a step, %s: write sim.step() at the end of your loop\n', ...
              link.robot, why);
    end

    function require_here(link)
    % Raises an error if a load has removed the robot.
      if link.lost_code == 10 && ~isempty(link.lost)
        coopdyn.internal.fail(10, link.lost);
      end
    end

    function text = take_again(link)
      text = ['sim.robot(''' link.robot ''')'];
    end

    function forget_commands(link)
      link.kept = [];
      link.sent = [];
      link.carried = [];
      link.commanded_at = -1;
      link.scans = struct();
    end

    function close(link)
      link.drives = false;
      if ~isempty(link.motors)
        link.motors.close();
      end
      for group = {link.readers, link.pushers}
        for name = fieldnames(group{1})'
          connection = group{1}.(name{1});
          connection.close();
        end
      end
    end
  end
end

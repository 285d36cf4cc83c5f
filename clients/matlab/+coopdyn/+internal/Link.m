% SPDX-License-Identifier: MIT
classdef Link < handle
%LINK A robot as this client drives it: its connections, and the command kept for the next step.
  properties
    robot
    label              % in errors
    names              % of the robots that this drives
    is_team = false
    in_team = false    % a team of this sim drives it: for reading only
    motors = []        % the connection that commands go through; [] = it has no motors
    readers = struct() % connections to other modules, by module
    pushers = struct() % connections that readings are pushed on, by module
    drives = false     % open, ours and not lost
    unclaimed = false  % nobody can have it: a recording was played when it was opened
    kept = []          % struct of command and data, for the next step
    sent = []          % likewise: its reply has not come yet
    lost = ''          % why it is not ours any more
    lost_code = 6
    attached = {}
    carried = []       % the readings that came with the reply to the last step
    labels = struct('step', -1, 'when', uint64(0), 'ids', {{}}, 'colours', {{}})  % ids and colours of the targets
  end
  methods
    function link = Link(address, robot, drives)
      link.robot = robot;
      link.label = robot;
      link.names = {robot};
      link.motors = coopdyn.internal.Connection(address, ['/' robot '/motors'], drives);
    end

    function claim(link)
      link.unclaimed = true;
      try
        link.motors.request(7, [], []);
      catch cause
        if strcmp(cause.identifier, 'coopdyn:owned')
          coopdyn.internal.fail(6, [link.robot ' cannot be driven: ' cause.message '. Stop the other program, or ' ...
            'free the robot on the page; to look on only: coopdyn.connect(''watch'', true)']);
        end
        rethrow(cause);
      end
      link.unclaimed = false;
    end

    function reopen(link, session)
      session.open_motors(link);
    end

    function text = take_again(link)
      text = ['sim.robot(''' link.robot ''')'];
    end

    function forget_commands(link)
      link.kept = [];
      link.sent = [];
      link.carried = [];
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

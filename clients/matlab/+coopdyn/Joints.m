% SPDX-License-Identifier: MIT
classdef Joints < coopdyn.internal.Parts
%JOINTS A group of joints that are driven together, such as an arm. Made by r.joints('arm').
%     arm = r.joints('arm');
%     arm.set_positions([0.5 -0.3 0 1.2 0 0.4 0]);     % rad, or m of a slider: a smooth move within the profile
%     while ~arm.arrived(), sim.step(); end
%     arm.set_positions(0.5, 'elbow');                 % one joint, by its name or its number from 1
%   Commands: set_positions, set_positions_direct, set_velocities, set_efforts, set_pwm, set_modes, hold. They accept one value
%   per named joint (none named: all), or one value for all of them; joints are a name, {'elbow', 'wrist'} or [1 3]. Like
%   set_velocity of a robot, they are sent with the next sim.step() in lockstep, and immediately in real time.
%   How joints are driven: set_compliance, set_profile, set_gains. Readings: get, get_modes, get_compliance, get_profile,
%   get_gains, get_limits, get_motion, arrived, get_references, get_drive_trains. Kinematics: get_chain, forward, inverse.
%   Units: rad, rad/s, N m; m, m/s, N of sliders. Rows are 1 x n.
  properties (Access = private)
    ids     % of the joints in chain
    chain = []
  end
  methods
    function j = Joints(session, link)
      j = j@coopdyn.internal.Parts(session, link, 'joint', 216);
    end

    % --- commands
    function set_positions(j, positions, joints)
    %SET_POSITIONS Moves joints smoothly to positions [rad, m], within their profile of speed and acceleration.
      coopdyn.internal.need(nargin, 2, 'arm.set_positions([0.5 0.2]) or arm.set_positions(0.5, ''elbow'')');
      if nargin < 3, joints = []; end
      j.command(204, positions, joints);
    end

    function set_positions_direct(j, positions, joints)
    %SET_POSITIONS_DIRECT Sets positions for the end of the step [rad, m], for your own trajectories.
      coopdyn.internal.need(nargin, 2, 'arm.set_positions_direct([0.5 0.2])');
      if nargin < 3, joints = []; end
      j.command(205, positions, joints);
    end

    function set_velocities(j, velocities, joints)
    %SET_VELOCITIES Velocities of joints [rad/s, m/s].
      coopdyn.internal.need(nargin, 2, 'arm.set_velocities([0.5 0.2]) or arm.set_velocities(0.5, ''elbow'')');
      if nargin < 3, joints = []; end
      j.command(206, velocities, joints);
    end

    function set_efforts(j, efforts, joints)
    %SET_EFFORTS Efforts of the motors [N m, N].
      coopdyn.internal.need(nargin, 2, 'arm.set_efforts([0.5 0.2]) or arm.set_efforts(0.5, ''elbow'')');
      if nargin < 3, joints = []; end
      j.command(207, efforts, joints);
    end

    function set_pwm(j, duties, joints)
    %SET_PWM Duties of the motors of drive trains, -1 to 1: the sign is the direction, 0 short-circuits the motor.
      coopdyn.internal.need(nargin, 2, 'arm.set_pwm([0.5 0.2]) or arm.set_pwm(0.5, ''elbow'')');
      if nargin < 3, joints = []; end
      j.command(222, duties, joints);
    end

    function set_modes(j, modes, joints)
    %SET_MODES Sets control modes: 'idle', 'position', 'direct', 'velocity', 'effort' or, with a drive train, 'pwm', or a cell
    %   array of these. Each joint stays where it is (idle and effort: without effort; pwm: braked) until its next command.
      coopdyn.internal.need(nargin, 2, 'arm.set_modes(''idle'')');
      if nargin < 3, joints = []; end
      modes = cellstr(modes);
      numbers = zeros(1, numel(modes));
      for k = 1:numel(modes)
        at = find(strcmp(joint_modes(), modes{k}), 1);
        if isempty(at)
          coopdyn.internal.fail(4, ['there is no mode ''' modes{k} '''; write one of: ' strjoin(joint_modes(), ', ')]);
        end
        numbers(k) = at - 1;
      end
      j.command(208, numbers, joints);
    end

    function hold(j, joints)
    %HOLD Holds joints at their present positions.
      if nargin < 2, joints = []; end
      j.link.command(j.session, 219, [], j.ids_of(joints));
    end

    % --- how joints are driven
    function set_compliance(j, k, d, offset, joints)
    %SET_COMPLIANCE Turns joints into springs in the modes 'position' and 'direct': effort = k (reference - position) - d velocity
    %   + offset; k [N m/rad], d [N m s/rad], offset [N m]. k = Inf: a servo again.
      coopdyn.internal.need(nargin, 2, 'arm.set_compliance(50, 2) or arm.set_compliance(50, 2, 0, [1 2])');
      if nargin < 3, d = 0; end
      if nargin < 4, offset = 0; end
      if nargin < 5, joints = []; end
      j.tune(210, {k, d, offset}, joints);
    end

    function set_profile(j, speed, acceleration, joints)
    %SET_PROFILE Sets speed [rad/s, m/s] and acceleration [rad/s2, m/s2] of the moves of set_positions.
      coopdyn.internal.need(nargin, 3, 'arm.set_profile(0.5, 2) or arm.set_profile(0.5, 2, [1 2])');
      if nargin < 4, joints = []; end
      j.tune(212, {speed, acceleration}, joints);
    end

    function set_gains(j, p, i, d, joints)
    %SET_GAINS Gains of the position servos: reference velocity = p error + i integral of it (docs/physics.md).
      coopdyn.internal.need(nargin, 2, 'arm.set_gains(20, 0, 0) or arm.set_gains(20, 0, 0, [1 2])');
      if nargin < 3, i = 0; end
      if nargin < 4, d = 0; end
      if nargin < 5, joints = []; end
      j.tune(214, {p, i, d}, joints);
    end

    % --- readings: of all joints, or of the named ones
    function v = get(j, varargin)
    %GET position [rad, m], velocity and effort of joints, a struct of rows; effort is NaN before the first step.
      v = j.reading(203, varargin{:});
    end

    function modes = get_modes(j, varargin)
    %GET_MODES The control modes of joints, a cell array of words as for set_modes.
      modes = j.reading(209, varargin{:});
    end

    function v = get_compliance(j, varargin)
    %GET_COMPLIANCE k, d and offset of joints.
      v = j.reading(211, varargin{:});
    end

    function v = get_profile(j, varargin)
    %GET_PROFILE speed and acceleration with which joints move to a position.
      v = j.reading(213, varargin{:});
    end

    function v = get_gains(j, varargin)
    %GET_GAINS p, i and d of the position servos.
      v = j.reading(215, varargin{:});
    end

    function v = get_limits(j, varargin)
    %GET_LIMITS lower and upper position (Inf = none), velocity and effort.
      v = j.reading(216, varargin{:});
    end

    function v = get_motion(j, varargin)
    %GET_MOTION arrived: which joints have completed the motion of set_positions; target: their targets.
      v = j.reading(217, varargin{:});
    end

    function yes = arrived(j, varargin)
    %ARRIVED True if the joints have reached the targets of set_positions; false until a step has run since.
      yes = false;
      if isempty(j.link.kept)
        motion = j.get_motion(varargin{:});
        yes = j.session.newest(2) > j.link.commanded_at && all(motion.arrived);
      end
    end

    function v = get_references(j, varargin)
    %GET_REFERENCES The active references: position, velocity, effort or duty, by mode.
      v = j.reading(218, varargin{:});
    end

    function v = get_drive_trains(j, varargin)
    %GET_DRIVE_TRAINS rotor_position [rad] and rotor_velocity [rad/s] of drive trains, on the joint side, current [A] and energy
    %   drawn by the motor [J]; NaN for joints without a drive train.
      v = j.reading(223, varargin{:});
    end

    % --- kinematics
    function chain = get_chain(j)
    %GET_CHAIN The chain from the robot's frame R to the tool, a coopdyn.Chain. Error if the joints branch.
      if isempty(j.chain)
        reply = j.session.read(j.link, j.name, 220, [], '');
        n = numel(reply.params) / 2;
        j.ids = reply.params(1:2:end);
        rows = reshape(reply.data(1:6 * n), 6, n)';
        t = reply.data(6 * n + 1:6 * n + 7);
        w = t(4); x = t(5); y = t(6); z = t(7);
        tool = [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), t(1); ...
                2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), t(2); ...
                2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), t(3); 0 0 0 1];
        limits = j.get_limits();
        j.chain = coopdyn.Chain(reply.params(2:2:end), rows(:, 1:3), rows(:, 4:6), tool, limits.lower(j.ids), ...
                                limits.upper(j.ids));
      end
      chain = j.chain;
    end

    function X = forward(j, q)
    %FORWARD The tool's pose in the robot's frame R, a 4 x 4 matrix, with all joints of the group at q [rad, m]; without q, at
    %   their present positions.
      if nargin < 2, q = []; end
      chain = j.get_chain();
      q = j.posture(q);
      X = chain.forward(q(j.ids));
    end

    function q = inverse(j, pose, q0)
    %INVERSE Positions of all joints, within their limits, that bring the tool to a pose in R (a 4 x 4 matrix as of forward, or
    %   only a position [x y z] in m); near q0 if possible (default: the present positions). Error if none are found.
      coopdyn.internal.need(nargin, 2, 'arm.inverse(pose) or arm.inverse([0.3 0 0.5], q0)');
      if nargin < 3, q0 = []; end
      chain = j.get_chain();
      q = j.posture(q0);
      q(j.ids) = chain.inverse(pose, q(j.ids));
    end
  end
  methods (Access = private)
    function tune(j, number, columns, joints)
      if j.session.watch
        coopdyn.internal.fail(5, 'this sim only watches; connect without ''watch'' to drive');
      end
      ids = j.ids_of(joints);
      rows = zeros(numel(columns), numel(ids));
      for k = 1:numel(columns)
        rows(k, :) = coopdyn.internal.spread(columns{k}, numel(ids), j.one);
      end
      if any(isnan(rows(:))) || any(any(isinf(rows(2:end, :)))) || (number ~= 210 && any(isinf(rows(1, :))))
        coopdyn.internal.fail(4, 'values must be finite; only k of a compliance may be Inf: a servo');
      end
      j.session.read(j.link, j.name, number, ids, '', reshape(rows, 1, []));
    end

    function q = posture(j, q)
      if isempty(q)
        now = j.get();
        q = now.position;
      elseif ~isnumeric(q) || numel(q) ~= numel(j.names)
        coopdyn.internal.fail(3, sprintf('a posture has a value for each of the %d joints: %s', numel(j.names), ...
                                         coopdyn.internal.list_of(j.names)));
      end
      q = reshape(double(q), 1, []);
    end
  end
end

function words = joint_modes()
  words = {'idle', 'position', 'direct', 'velocity', 'effort', 'pwm'};
end

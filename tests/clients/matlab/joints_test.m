% SPDX-License-Identifier: MIT
% needs: daemon arms
% An arm in lockstep and in real time, a robot with wheels and an arm, kinematics, refused commands.
sim = coopdyn.connect();
r = sim.robot('arm1');
m = sim.robot('m1');
arm = r.joints();
assert(numel(arm.names) == 7);
bent = [0 0.8 0 0.8 0 0.8 0];
arm.set_positions(bent);
assert(~arm.arrived());  % no step has run yet
while ~arm.arrived(), sim.step(); end
now = arm.get();
assert(max(abs(now.position - bent)) < 1e-3);

% The tool moves to the pose given to inverse.
pose = arm.forward();
pose(3, 4) = pose(3, 4) + 0.1;
arm.set_positions(arm.inverse(pose));
sim.step();
while ~arm.arrived(), sim.step(); end
assert(norm(arm.forward() - pose) < 1e-3);

% One step accepts several commands of one kind, but not of two kinds.
arm.set_velocities(0.1, 1);
arm.set_velocities([0.3 0.2], {'joint_1', 'joint_2'});
expect_error('coopdyn:not_possible', @() arm.set_positions(0.1, 3), 'sim.step() between them');
sim.step();
assert(isequal(arm.get_references([1 2]), [0.3 0.2]));
modes = arm.get_modes();
assert(all(strcmp(modes(1:2), 'velocity')));
arm.hold();
sim.step(5);
assert(all(strcmp(arm.get_modes(), 'position')));

% Tuning of joints.
arm.set_profile(0.5, 2, 1);
assert(isequal(arm.get_profile(1), struct('speed', 0.5, 'acceleration', 2)));
arm.set_compliance(50, 2, 0, [1 2]);
compliance = arm.get_compliance();
assert(isequal(compliance.k(1:3), [50 50 Inf]));
arm.set_compliance(Inf);

% Wheels and an arm step together.
x = m.get_pose().x;
marm = m.joints('arm');
m.set_velocity(0.2, 0);
marm.set_velocities(0.1, 1);
sim.step(50);
s = m.sense();
assert(s.pose.x > x + 0.05 && s.joints.arm.position(1) > 0.04);

expect_error('coopdyn:no_such_name', @() arm.set_positions(1, 'elbow'), 'joint_1');
expect_error('coopdyn:wrong_data', @() arm.set_positions([1 2]), 'each of the 7 joints');
expect_error('coopdyn:out_of_range', @() arm.set_modes('fast'), 'idle');
expect_error('coopdyn:no_such_name', @() r.joints('leg'));
expect_error('coopdyn:not_possible', @() r.set_velocity(1, 0), 'no motors');

% In real time, the same.
sim.set_mode('realtime');
arm.set_positions(0.3, 'joint_3');
while ~arm.arrived(), sim.step(); end
now = arm.get(3);
assert(abs(now.position - 0.3) < 1e-3);
sim.close();
disp('passed');

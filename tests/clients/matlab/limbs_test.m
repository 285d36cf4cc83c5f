% SPDX-License-Identifier: MIT
% needs: limbs
% Muscles, thrusters and the drive train of a robot, in lockstep and in real time, and refused commands.
sim = coopdyn.connect();
r = sim.robot('robot1');
m = r.muscles();
t = r.thrusters();
j = r.joints();
assert(isequal(m.names, {'biceps', 'triceps'}) && isequal(t.names, {'jet', 'spin'}));
assert(isequal(m.get_limits(), struct('max_force', [30 30], 'optimal_length', [0.5 0.5], 'max_velocity', [2 2])));
assert(isequal(t.get_limits(), struct('max_thrust', [5 0.2])));

% Commands are sent with the next step, and hold.
m.set_activations(0.1);
t.set_thrusts([2 0.1]);
j.set_pwm(0.5);
now = m.get();
assert(isequal(now.activation, [0 0]));
sim.step();
m.set_activations(0.8, 'biceps');
t.set_thrusts(-1, 1);
sim.step(50);
assert(sim.steps == 51);
now = m.get();
assert(isequal(now.activation, [0.8 0.1]) && now.force(1) > now.force(2) && now.length(1) < 0.45);
assert(now.length_factor(1) < 1 && now.velocity_factor(1) < 1);
one = m.get('triceps');
assert(one.length == now.length(2));
now = t.get();
assert(isequal(now.thrust, [-1 0.1]) && numel(now.velocity) == 2);

% The drive train: half of 50 rad/s, over a gear of 10.
assert(isequal(j.get_modes(), {'pwm'}) && j.get_references() == 0.5);
now = j.get();
assert(abs(now.velocity - 2.5) < 1e-3);
train = j.get_drive_trains('knee');
assert(abs(train.rotor_position - now.position) < 1e-3 && abs(train.rotor_velocity - 2.5) < 1e-3);
assert(isfinite(train.current) && train.energy > 0);
j.set_modes('pwm');
sim.step();
assert(j.get_references() == 0);  % it brakes

other = sim.robot('robot2');
expect_error('coopdyn:not_possible', @() other.muscles(), 'robot2 has no muscles; its actuators: motors');
expect_error('coopdyn:not_possible', @() other.thrusters(), 'robot2 has no thrusters; its actuators: motors');
expect_error('coopdyn:no_such_name', @() m.set_activations(1, 'calf'), 'biceps, triceps');
expect_error('coopdyn:out_of_range', @() m.get(3), 'muscles 1 to 2');
expect_error('coopdyn:wrong_data', @() t.set_thrusts([1 2 3]), 'each of the 2 thrusters');
expect_error('coopdyn:out_of_range', @() t.set_thrusts(NaN), 'finite');
expect_error('coopdyn:wrong_params', @() m.set_activations(), 'm.set_activations(');

% In real time, the same.
sim.set_mode('realtime');
m.set_activations(0.3);
sim.step(2);
now = m.get();
assert(isequal(now.activation, [0.3 0.3]));

% Closing a sim releases them.
sim.set_mode('lockstep');
sim.close();
sim = coopdyn.connect();
r = sim.robot('robot1');
sim.step();
now = r.muscles().get();
assert(isequal(now.activation, [0 0]));
sim.close();
disp('passed');

% SPDX-License-Identifier: MIT
% needs: limbs
% The channel of a robot: its motors and values by name and range, in lockstep and in real time.
sim = coopdyn.connect();
r = sim.robot('robot1');
m = r.muscles();
c = r.channel();
assert(isequal({c.motors.name}, {'knee_motor', 'pull'}) && isequal({c.values.name}, {'knee_speed', 'place', 'place'}));
knee = c.motors(1);
assert(isequal([knee.internal_min knee.internal_max knee.external_min knee.external_max], [-4 4 -1 1]) && ~knee.auxiliary);
assert(c.values(2).auxiliary && c.values(2).external_max == Inf && c.steps == 2);

% Values are set with the next step and hold; setting one motor by name leaves the others unchanged.
expect_error('coopdyn:not_possible', @() c.set(0.2, 'pull'), 'all 2 motors first');
c.set([0.5 0.3]);
sim.step(40);
assert(sim.steps == 40);
assert(abs(c.get('knee_speed') - 0.5) < 1e-3);
now = m.get('biceps');
assert(now.activation == 0.3);
c.set(0.2, 'knee_motor');
sim.step(40);
v = c.get();
assert(abs(v(1) - 0.2) < 1e-3 && isequal(c.get('place'), v(2:3)) && isequal(c.get([3 1]), v([3 1])));
assert(~c.aborted());
now = m.get('biceps');
assert(now.activation == 0.3);

% Nothing else drives the robot.
expect_error('coopdyn:not_possible', @() m.set_activations(1), 'driven through its channel');
s = r.sense();
assert(s.step == 80);
expect_error('coopdyn:no_such_name', @() c.set(0.2, 'push'), 'knee_motor, pull');
expect_error('coopdyn:wrong_data', @() c.set([1 2 3]), 'each of the 2 motors');
other = sim.robot('robot2');
expect_error('coopdyn:not_possible', @() other.channel(), 'robot2 has no channel; its actuators: motors');

sim.set_mode('realtime');
c.set([-0.5 0]);
while abs(c.get('knee_speed') + 0.5) > 1e-3, sim.step(); end
sim.close();
disp('passed');

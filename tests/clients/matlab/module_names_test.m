% SPDX-License-Identifier: MIT
% needs: legs
% Modules are found by their type: this robot's motors are called legs, its compass is called north.
sim = coopdyn.connect();
r = sim.robot('robot1');
r.set_velocity(0.2, 0);
sim.step(20);
s = r.sense();
assert(s.pose.x > 0 && s.wheels.left_speed > 1);
assert(isequal(r.get_wheels(), s.wheels));
assert(r.get_compass() == s.compass && r.get_compass('north') == s.compass);
a = r.call('motors', 'get_wheels');
b = r.call('legs', 'get_wheels');
assert(isequal(a.data, b.data));
r.subscribe('motors');
sim.step();
u = r.next('motors', 'timeout', 60);
assert(u.step == 21);
expect_error('coopdyn:no_such_name', @() r.get_compass('south'), 'south');
sim.close();
disp('passed')

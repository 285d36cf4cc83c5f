% SPDX-License-Identifier: MIT
% needs: daemon classroom
% Text instead of a number is an error without a warning; an unknown machine is reported as such.
sim = coopdyn.connect();
r = sim.robot(1);
lastwarn('');
expect_error('coopdyn:wrong_data', @() r.set_velocity("a", 0), 'v [m/s] must be one number');
expect_error('coopdyn:wrong_data', @() r.set_velocity(0, 'ab'), 'w [rad/s] must be one number');
expect_error('coopdyn:wrong_data', @() r.set_velocity([1; 2], 0), 'v [m/s] must be one number');
expect_error('coopdyn:wrong_data', @() r.set_wheel_speeds("a", 0), 'left [rad/s] must be one number');
assert(isempty(lastwarn()), lastwarn());
r.set_velocity(single(0.1), int8(0));
expect_error('coopdyn:connection', @() coopdyn.connect('no-such-machine.invalid'), 'no-such-machine.invalid');
disp('passed')

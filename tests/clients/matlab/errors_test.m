% SPDX-License-Identifier: MIT
% needs: fake --robots 2
% Commands are checked before anything is written; errors have identifiers.
sim = coopdyn.connect();
r = sim.robot(1);
expect_error('coopdyn:out_of_range', @() r.set_velocity(NaN, 0), 'v [m/s]');
expect_error('coopdyn:out_of_range', @() r.set_wheel_speeds(0, Inf), 'right');
expect_error('coopdyn:wrong_data', @() r.set_velocity([1 2], 0), 'one number');
expect_error('coopdyn:wrong_data', @() r.set_velocity('fast', 0));
expect_error('coopdyn:no_such_name', @() r.get_target('blue'), 'blue');
expect_error('coopdyn:no_such_name', @() r.sense('blue'), 'red');
expect_error('coopdyn:no_such_name', @() sim.robot('robbot'), 'robot1, robot2');
expect_error('coopdyn:no_such_name', @() sim.robot(3), 'robot1, robot2');
expect_error('coopdyn:unknown_command', @() sim.call('/robot1/pose', 'set_velocity'), 'get_pose');
expect_error('coopdyn:out_of_range', @() sim.step(0));
expect_error('coopdyn:not_possible', @() r.next(), 'r.subscribe');
watch = coopdyn.connect('watch', true);
other = watch.robot(1);
assert(numel(other.get_distances()) == 11);
first = watch.steps;
watch.step();
assert(watch.steps > first);
expect_error('coopdyn:not_possible', @() other.set_velocity(0, 0), 'only watches');
sim.close();
expect_error('coopdyn:connection', @() sim.step(), 'closed');
ben = coopdyn.connect('name', 'ben');
for k = 1:500  % close does not wait: the robot is free soon; watching has not claimed it
  try
    taken = ben.robot(1);
    break
  catch cause
    assert(strcmp(cause.identifier, 'coopdyn:owned'));
    pause(0.01);
  end
end
assert(strcmp(taken.name, 'robot1'));
disp('passed')

% SPDX-License-Identifier: MIT
% needs: daemon formation --mode lockstep
% A reset or load by another client is reported once, by the first call that notices; the program can then start over.
sim = coopdyn.connect();
other = coopdyn.connect('name', 'other');
again = 'run your program again, or catch this to start over';
sim.set_participants({'robot1'});
r = sim.robot('robot1');
drive_steps(sim, r, 3);
other.reset();  % between two steps
r.set_velocity(0.1, 0);
expect_error('coopdyn:reset', @() sim.step('timeout', 60), 'the world was reset', again);
drive_steps(sim, r, 3);
other.reset();
expect_error('coopdyn:reset', @() r.get_pose(), 'the world was reset', again);
drive_steps(sim, r, 3);
p = r.get_pose();
assert(sim.steps == 3 && p.x > -3.99);
r.sense();
sim.step('timeout', 60);
r.sense();  % readings in the step's reply
other.reset();
expect_error('coopdyn:reset', @() r.sense(), 'the world was reset');
for own = {@() sim.reset(), @() sim.reload(), @() sim.call('/simulation', 'reset')}  % of our own: no error
  own{1}();
  r.get_pose();
  sim.set_participants({'robot1'});
  drive_steps(sim, r, 3);
end
watch = coopdyn.connect('watch', true);
seen = watch.robot('robot1');
seen.get_pose();
other.reset();
seen.get_pose();  % a program that only watches gets no error
expect_error('coopdyn:reset', @() r.get_wheels(), 'the world was reset');
drive_steps(sim, r, 1);
% Two robots, a team, real time.
two = sim.robot('robot2');
sim.set_participants({'robot1', 'robot2'});
drive_steps(sim, r, 3);
other.reset();
expect_error('coopdyn:reset', @() sim.step('timeout', 60), 'the world was reset');
sim.close();
sim = coopdyn.connect();
team = sim.team({'robot1', 'robot2'});
for k = 1:3
  team.step([0.1 0], 'timeout', 60);
end
other.reset();
expect_error('coopdyn:reset', @() team.step([0.1 0], 'timeout', 60), 'the world was reset');
team.step([0.1 0], 'timeout', 60);
other.reset();
expect_error('coopdyn:reset', @() team.read(), 'the world was reset');
s = team.step([0.1 0], 'timeout', 60);
assert(s.step == 1);
team.close();
r = sim.robot('robot1');
sim.set_mode('realtime');
drive_steps(sim, r, 30);
other.pause();
other.reset();
expect_error('coopdyn:reset', @() r.set_velocity(0.1, 0), 'the world was reset');
r.set_velocity(0.1, 0);
other.run();
drive_steps(sim, r, 2);
% Loads.
two = sim.robot('robot2');
two.get_pose();
drive_steps(sim, r, 30);
other.pause();
other.load_scenario('fig4');
expect_error('coopdyn:reset', @() two.get_pose(), 'scenario fig4 was loaded, which has no robot2; there are: robot1');
expect_error('coopdyn:no_such_name', @() two.get_pose(), 'the scenario that was loaded has no robot2; there are: robot1');
expect_error('coopdyn:no_such_name', @() two.set_velocity(0, 0), 'the scenario that was loaded has no robot2');
other.run();
sim.set_mode('realtime');
drive_steps(sim, r, 2);
% A load between two steps, while the next step waits for others.
sim.set_mode('lockstep');
sim.set_participants({'robot1'});
drive_steps(sim, r, 2);
other.load_scenario('formation');
sim.set_mode('lockstep');
r.set_velocity(0.1, 0);
expect_error('coopdyn:reset', @() sim.step('timeout', 60), 'scenario formation was loaded', again);
sim.close();
disp('passed')

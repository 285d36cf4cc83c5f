% SPDX-License-Identifier: MIT
% needs: recording looked_at --duration 0.8
% Robots that a program only reads: it claims them when it drives them or steps with them, if they are free.
sim = coopdyn.connect('name', 'ana');
sim.pause();
auto = sim.robot('auto');
before = auto.get_pose();
mini = sim.robot('mini_4');
sim.seek(9);
expect_error('coopdyn:timed_out', @() sim.step(1, 'timeout', 0.1), 'the recording has ended; sim.run() plays it again');
sim.branch(0.6);
sim.set_mode('lockstep');
sim.run();
near = sim.robot('mini_2');
p = near.get_pose();
assert(p.forward == 0);
team = sim.team('mini');
assert(team.n == 4);
for k = 1:3
  team.step([0.1 0], 'timeout', 60);
end
for k = 1:3
  sim.step(1, 'timeout', 60);
end
assert(sim.steps == 66 && ~isequal(auto.get_pose(), before));
s = auto.sense();
assert(s.step == 66 && isequal(s.pose, auto.get_pose()));
w = mini.get_wheels();
assert(w.left_speed > 0);
for r = {mini, near}
  expect_error('coopdyn:not_possible', @() r{1}.set_velocity(0.1, 0), 'is driven by its team');
end
expect_error('coopdyn:owned', @() auto.set_velocity(0.1, 0), 'controller diffuse', 'watch');
sim.step(1, 'timeout', 60);
sim.release_robot('auto');
auto.set_velocity(0.1, 0);
sim.step(1, 'timeout', 60);
w = auto.get_wheels();
assert(w.left_speed > 0);
team.release();
robots = {mini, near, sim.robot('mini_1'), sim.robot('mini_3')};
for k = 1:4
  robots{k}.set_velocity(0.05, 0);
end
sim.step(1, 'timeout', 60);
status = sim.status();
assert(all(strcmp({status.robots.owner}, 'ana')));
expect_error('coopdyn:owned', @() sim.team('mini'), 'mini_1 is driven by ana');
sim.close();
disp('passed')

% SPDX-License-Identifier: MIT
% needs: daemon swarm100 --no-http --no-render
% A team that lost all its robots takes none back from its successor; one that lost some continues with the rest.
others = coopdyn.connect('name', 'C');
sim = coopdyn.connect('name', 'A');
first = sim.team('mini');
first.step('timeout', 60);
others.load_scenario('classroom');
others.load_scenario('swarm100');
expect_error('coopdyn:reset', @() first.step('timeout', 60), 'scenario swarm100 was loaded');
team = sim.team('swarm1');
team.step('timeout', 60);
expect_error('coopdyn:owned', @() sim.team('mini_1'), 'robot mini_1 belongs to your team swarm1: drive it there');
expect_error('coopdyn:wrong_data', @() team.step([]), 'V is 0 x 0, the team has 100 robots');
others.pause();
expect_error('coopdyn:timed_out', @() team.step('timeout', 0.1), 'paused');
others.run();
s = team.read();
assert(isequal(size(s.pose), [100 3]));
others.set_mode('realtime');
team.step([0.1 0], 'timeout', 60);
others.call('/simulation', 'release_robot', [], [], 'mini_5');
r = others.robot('mini_5');
r.set_velocity(0, 0.5);
s = team.step([0.1 0], 'timeout', 60);
assert(size(s.pose, 1) == 99 && team.n == 99 && ~any(strcmp(team.names, 'mini_5')));
others.call('/simulation', 'release_robot', [], [], 'mini_7');
r = others.robot('mini_7');
r.set_velocity(0, 0.5);
for k = 1:2
  expect_error('coopdyn:wrong_data', @() team.step(zeros(99, 2), 'timeout', 60), 'has lost mini_7: V must have 98 rows now');
end
s = team.step(zeros(98, 2), 'timeout', 60);
assert(size(s.pose, 1) == 98);
sim.close();
others.close();
disp('passed')

% SPDX-License-Identifier: MIT
% needs: recording classroom --duration 0.6
% A team reads a played recording; after a branch it drives.
sim = coopdyn.connect();
sim.pause();
team = sim.team();
assert(isequal(team.names, {'robot1'}) && team.ids == 1);
team.close();
r = sim.robot('robot1');
team = sim.team('robot1');
for time = [0.3 0.5]
  sim.seek(time);
  s = team.read();
  p = r.get_pose();
  assert(s.step == round(100 * time) && isequal(s.distances, reshape(r.get_distances(), 1, [])));
  assert(isequal(s.pose, [p.x p.y p.heading]));
end
team.select('wheels', 'distances', 'pose');
t = team.read();
assert(isequal(t.pose, s.pose) && isequal(t.distances, s.distances));
expect_error('coopdyn:not_possible', @() team.step([0.1 0]), 'playing a recording');
expect_error('coopdyn:not_possible', @() team.step_wheels([1 1]), 'playing a recording');
expect_error('coopdyn:not_possible', @() team.stop(), 'playing a recording');
expect_error('coopdyn:no_such_name', @() sim.team('robot9'), 'robot9');
sim.set_loop(true);
sim.play(0.1);  % so slow that no round is over meanwhile
before = team.read();
s = team.step('timeout', 60);
assert(s.step ~= before.step);
sim.step(1, 'timeout', 60);
sim.pause();
sim.branch(0.3);
sim.run();
before = team.read();
for k = 1:20
  s = team.step([0.3 0], 'timeout', 60);
end
assert(s.step >= 50 && s.pose(1) ~= before.pose(1));
sim.close();
disp('passed')

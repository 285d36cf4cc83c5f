% SPDX-License-Identifier: MIT
% needs: daemon swarm100 --no-http --no-render
% A team of a hundred: rows agree with the robots' readings; messages pass between robots.
sim = coopdyn.connect();
team = sim.team('swarm1');
assert(team.n == 100 && strcmp(team.names{100}, 'mini_100') && team.ids(100) == 100);
names = sim.robots();
assert(isequal(names, team.names));
team.select('pose', 'distances', 'wheels', 'neighbours', 2, 'compass');
for k = 1:20
  s = team.step([0.1 0.2], 'timeout', 60);
  assert(s.step == k);
end
assert(isequal(size(s.pose), [100 3]) && isequal(size(s.neighbours), [100 6]));
for i = [1 57 100]
  r = sim.robot(team.names{i});
  p = r.get_pose();
  assert(isequal(s.pose(i, :), [p.x p.y p.heading]));
  assert(isequal(s.distances(i, :), r.get_distances()));
  w = r.get_wheels();
  assert(s.wheels(i, 3) == w.left_speed);
  assert(s.compass(i) == p.heading && r.get_compass() == p.heading && r.get_compass('compass') == p.heading);
  assert(r.sense().compass == p.heading);
end
s = team.step([0.1 * ones(100, 1), linspace(-0.5, 0.5, 100)'], 'timeout', 60);
s = team.step([9 0], 'timeout', 60);
assert(strcmp(s.text, 'limited 100 robots'));
i = find(s.neighbours(:, 1) > 0, 1);
sender = sim.robot(team.names{i});
near = sender.get_neighbours();
sender.send_message([1 -2.5]);
listener = sim.robot(near(1).name);
for k = 1:20
  sim.step('timeout', 60);
  heard = listener.get_messages();
  if ~isempty(heard)
    break
  end
end
assert(heard(1).id == team.ids(i) && isequal(heard(1).values, [1 -2.5]) && heard(1).distance > 0);
assert(isempty(sender.get_messages()));
sim.load_scenario('swarm100');
again = sim.team('swarm1');
assert(again.n == 100 && numel(again.names) == 100);
s = again.step(0.1 * ones(again.n, 2), 'timeout', 60);
assert(isequal(size(s.pose), [100 3]));
sim.load_scenario('swarm100');
all = sim.team();  % the old team loses its robots to it
assert(all.n == 100);
all.step([0.1 0], 'timeout', 60);
all.close();
sim.load_scenario('classroom');
expect_error('coopdyn:no_such_name', @() team.step(), 'swarm1');
sim.close();
disp('passed')

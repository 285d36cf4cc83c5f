% SPDX-License-Identifier: MIT
% needs: fake --robots 3 --mode lockstep
% A team: one row for each robot; readings are matrices; together with a robot that is driven singly.
sim = coopdyn.connect();
r = sim.robot('robot3');
team = sim.team({'robot1', 'robot2'});
assert(isequal(team.names, {'robot1', 'robot2'}) && isequal(team.ids, [1 2]) && team.n == 2);
r.set_velocity(0.5, 0);
s = team.step([0.1 0; 0.2 0], 'timeout', 60);
assert(s.step == 1 && s.time == 0.01 && isempty(s.text));
assert(isequal(size(s.pose), [2 3]) && isequal(size(s.distances), [2 11]));
assert(max(max(abs(s.pose - [0.001 0 0; 0.002 1 0]))) < 1e-12);
assert(s.distances(1, 6) == 3.999 && isinf(s.distances(2, 1)));
s = team.step();
p = r.get_pose();
assert(s.step == 2 && p.forward == 0.5);
assert(abs(s.pose(2, 1) - 0.004) < 1e-12);
r.set_velocity(0.25, 0);
sim.step('timeout', 60);
sim.step(3, 'timeout', 60);
assert(sim.steps == 6);
t = team.read();
p = r.get_pose();
assert(t.step == 6 && abs(t.pose(2, 1) - 0.012) < 1e-12 && p.forward == 0.25);
s = team.step([0.3 0]);
s = team.step_wheels([1 1; 1 1]);
team.select('targets', 'wheels');
s = team.read();
assert(isequal(size(s.targets), [2 4]) && isequal(size(s.wheels), [2 4]) && ~isfield(s, 'pose'));
team.select('neighbours', 1, 'pose');
other = sim.robot('robot2');
assert(numel(other.get_distances()) == 11);
expect_error('coopdyn:not_possible', @() other.set_velocity(1, 0), 'robot2 is driven by its team');
expect_error('coopdyn:not_possible', @() r.get_neighbours(), 'robot3 has no module neighbours', 'minibot');
expect_error('coopdyn:wrong_data', @() r.send_message(1:9), '1 to 8 numbers');
expect_error('coopdyn:out_of_range', @() r.send_message([1 NaN]), 'must be finite');
% Checked before anything is written, naming the row.
steps = sim.steps;
expect_error('coopdyn:wrong_data', @() team.step([1 2; 3 4; 5 6]), 'V is 3 x 2, the team has 2 robots; write 2 x 2');
expect_error('coopdyn:wrong_data', @() team.step({1, 2}), 'V is a matrix of numbers');
expect_error('coopdyn:out_of_range', @() team.step([1 2; 3 NaN]), 'row 2 of V (robot2)');
expect_error('coopdyn:wrong_data', @() team.step_wheels([]), 'W is 0 x 0');
expect_error('coopdyn:out_of_range', @() team.select('poses'), 'there are: pose, distances');
expect_error('coopdyn:wrong_data', @() sim.team({}), 'sim.team()');
assert(sim.steps == steps);
team.close();
expect_error('coopdyn:not_possible', @() team.step(), 'was given up', 'team of 2 robots');
team = sim.team();
assert(isequal(team.names, {'robot1', 'robot2'}));
sim.close();
disp('passed')

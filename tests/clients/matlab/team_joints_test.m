% SPDX-License-Identifier: MIT
% needs: daemon kinds --no-http --no-render
% A team of robots of different kinds: joints, several kinds of commands in one step.
sim = coopdyn.connect();
sim.set_participants({'wheels1', 'arm1', 'both1'});
team = sim.team({'wheels1', 'arm1', 'both1'});
team.select('pose', 'joints');
before = team.read();
bent = [0 0.8 0 0.8 0 0.8 0];
V = [0.2 0; NaN NaN; 0.1 0];
Q = [NaN(1, 7); bent; 0.3 * ones(1, 6) NaN];
for k = 1:150
  s = team.step('velocities', V, 'positions', Q, 'timeout', 60);
end
assert(abs(s.pose(1, 1) - before.pose(1, 1) - 0.3) < 0.02);
assert(abs(s.pose(3, 1) - before.pose(3, 1) - 0.15) < 0.02);
assert(isnan(s.joints(1, 1)));
assert(max(abs(s.joints(3, 1:3:18) - 0.3)) < 0.01);
now = sim.robot('both1').joints('arm').get();
assert(isequal(now.position, s.joints(3, 1:3:18)));
team.close();

% Commands of different kinds for groups of one robot.
sim.set_participants({'human1'});
team = sim.team({'human1'});
human = sim.robot('human1');
waist = human.joints('waist').get_modes();
team.step('positions/left_arm', [0.1 0.2 0 -0.3], 'joint_velocities/neck', [0.2 0], 'efforts/right_arm', [0.5 0 0 0], ...
          'timeout', 60);
assert(all(strcmp(human.joints('left_arm').get_modes(), 'position')));
assert(isequal(human.joints('neck').get_references(), [0.2 0]));
assert(all(strcmp(human.joints('right_arm').get_modes(), 'effort')));
assert(isequal(human.joints('waist').get_modes(), waist));

expect_error('coopdyn:out_of_range', @() team.step('position', 0), 'positions_direct');
expect_error('coopdyn:wrong_data', @() team.step('positions'), 'a row for each robot');
expect_error('coopdyn:wrong_data', @() team.step('positions', zeros(2, 25)), '2 x 25');
expect_error('coopdyn:out_of_range', @() team.step('efforts/neck', [Inf 0]), 'finite');
expect_error('coopdyn:no_such_name', @() team.step('efforts/leg', 0), 'left_arm');
sim.close();
disp('passed')

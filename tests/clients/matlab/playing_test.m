% SPDX-License-Identifier: MIT
% needs: recording classroom --duration 0.6
% A played recording: sensors and poses work, robots cannot be driven, and a branch continues live.
sim = coopdyn.connect();
r = sim.robot('robot1');
sim.pause();
p = sim.playback();
assert(p.begin_time == 0 && abs(p.end_time - 0.6) < 1e-9 && ~p.playing && ~p.loop && ~p.growing);
sim.seek(0.3);
assert(sim.steps == 30);
there = sim.hash();
s = r.sense('red');
assert(s.step == 30 && numel(s.distances) == 11 && isequal(s.pose, r.get_pose()));
for k = 1:2
  expect_error('coopdyn:not_possible', @() r.set_velocity(0.1, 0), 'playing a recording');
end
expect_error('coopdyn:wrong_data', @() sim.set_loop('yes'), 'true or false');
sim.skip(10);
assert(sim.steps == 40);
sim.skip(-20);
assert(sim.steps == 20);
sim.set_loop(true);
sim.play(0.1);  % so slow that no round is over meanwhile
before = sim.steps;
sim.step(1, 'timeout', 60);
assert(sim.steps ~= before);
sim.set_play_speed(-1);
p = sim.playback();
assert(p.speed == -1 && p.loop && p.playing);
expect_error('coopdyn:out_of_range', @() sim.play(0));
sim.pause();
sim.branch(0.3);
assert(sim.steps == 30 && strcmp(sim.hash(), there));
sim.set_mode('lockstep');
sim.run();
for k = 1:5
  r.set_velocity(0.2, 0);
  sim.step(1, 'timeout', 60);
end
assert(sim.steps == 35);
w = r.get_wheels();
assert(w.left_speed > 0);
expect_error('coopdyn:not_possible', @() sim.playback(), 'coopdyn play');
sim.close();
disp('passed')

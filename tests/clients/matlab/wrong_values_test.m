% SPDX-License-Identifier: MIT
% needs: fake --mode lockstep
% An error names the wrong value; values that the daemon would refuse are reported in the client's words.
sim = coopdyn.connect();
r = sim.robot(1);
expect_error('coopdyn:wrong_data', @() r.set_velocity('abc', 0), 'v [m/s] must be one number, not ''abc''');
expect_error('coopdyn:wrong_data', @() r.set_velocity([1 2], 0), 'v [m/s] must be one number, not [1 2]');
expect_error('coopdyn:wrong_data', @() r.set_velocity({1}, 0), 'v [m/s] must be one number, not a 1 x 1 cell');
expect_error('coopdyn:wrong_data', @() r.send_message('a'), 'a message is a row of 1 to 8 numbers, not ''a''');
expect_error('coopdyn:wrong_data', @() r.get_target({'red'}), 'not a 1 x 1 cell; write r.get_target(''red'')');
expect_error('coopdyn:wrong_data', @() r.get_target(''), 'a target is a colour or an id, not ''''; write r.get_target(''red'')');
expect_error('coopdyn:wrong_params', @() r.get_target(1.5), 'the id of a target must be a whole number, not 1.5');
expect_error('coopdyn:wrong_data', @() r.subscribe(5), 'is one word, not 5');
expect_error('coopdyn:wrong_params', @() r.subscribe('pose', 0.5), 'n must be a whole number, not 0.5');
expect_error('coopdyn:wrong_data', @() sim.robot({}), 'not a 0 x 0 cell; write sim.robot(''robot1'')');
expect_error('coopdyn:wrong_data', @() sim.team(5), 'robots are named, not 5; write e.g. sim.team(''swarm1'')');
expect_error('coopdyn:wrong_data', @() sim.team({'robot1', 5}), 'robots are named, not 5;');
expect_error('coopdyn:wrong_data', @() sim.set_participants({5}), 'not 5; write e.g. sim.set_participants({''robot1'', ''robot2''})');
expect_error('coopdyn:out_of_range', @() sim.step(0), 'n must be at least 1, not 0');
expect_error('coopdyn:out_of_range', @() sim.step(2^31), 'n must be a whole number of 32 bits, not 2147483648');
expect_error('coopdyn:out_of_range', @() sim.step(20000000), 'n must be at most 10000000, not 20000000: write sim.step(');
expect_error('coopdyn:out_of_range', @() sim.set_mode('slow'), 'there is no mode ''slow''; write one of realtime, lockstep, free');
expect_error('coopdyn:out_of_range', @() sim.set_step(5), 'a step lasts 0.0005 to 0.1 s, not 5: write sim.set_step(0.01)');
expect_error('coopdyn:out_of_range', @() sim.set_step(0.0012346), 'not 0.0012346 s: write sim.set_step(0.001235)');
expect_error('coopdyn:wrong_params', @() sim.reset('a'), 'a seed is a whole number of 32 bits, not ''a''');
expect_error('coopdyn:out_of_range', @() sim.reset(-1), 'a seed is at least 0, not -1: write sim.reset(7)');
expect_error('coopdyn:wrong_data', @() sim.load_scenario(''), 'a scenario is a text, not '''': write sim.load_scenario(''corridor'')');
expect_error('coopdyn:wrong_data', @() sim.load_scenario(5), 'a scenario is a text, not 5');
expect_error('coopdyn:wrong_data', @() sim.note(''), 'a note is a text, not '''': write sim.note(''half-time'')');
expect_error('coopdyn:out_of_range', @() sim.save_state('1st'), 'at most 63: write sim.save_state(''before_turn'')');
expect_error('coopdyn:out_of_range', @() sim.play(65), 'not 65: write sim.play(2)');
expect_error('coopdyn:out_of_range', @() sim.set_play_speed(0), 'not 0: write sim.play(2), or sim.pause()');
expect_error('coopdyn:out_of_range', @() sim.skip(0), 'not 0: write sim.skip(1)');
expect_error('coopdyn:wrong_params', @() sim.skip('a'), 'n must be a whole number of steps, not ''a''');
expect_error('coopdyn:wrong_data', @() sim.set_loop(2), 'on is true or false, not 2');
expect_error('coopdyn:wrong_data', @() sim.describe(5), '''/robot1/motors'', is one word, not 5');
expect_error('coopdyn:wrong_data', @() coopdyn.read_run(5), 'the name of a recording is a text, not 5');
for step_s = [0.0005 0.000501 0.033333 0.1]
  sim.set_step(step_s);
  assert(sim.dt == step_s);
end
sim.set_participants({});
sim.set_participants([]);
sim.set_participants({'robot1'});
other = coopdyn.connect([]);
assert(numel(other.robots()) == 1);
disp('passed')

% SPDX-License-Identifier: MIT
% needs: fake --robots 2 --mode lockstep
% A call with missing arguments says what to write; two speeds may be given as one row; a number is a port.
sim = coopdyn.connect();
r = sim.robot(1);
sim.robot(2);
r.set_velocity([0.2 0.5]);
sim.step('timeout', 60);
p = r.get_pose();
assert(p.forward == 0.2 && p.turn == 0.5);
r.set_velocity([0.3; 0.1]);
sim.step('timeout', 60);
r.set_wheel_speeds([2 2]);
sim.step('timeout', 60);
p = r.get_pose();
assert(abs(p.forward - 0.15) < 1e-12 && p.turn == 0);
expect_error('coopdyn:wrong_data', @() r.set_velocity(), 'write r.set_velocity(0.2, 0.5)', 'r.set_velocity([0.2 0.5])');
expect_error('coopdyn:wrong_data', @() r.set_velocity(0.2), 'write r.set_velocity(0.2, 0.5)');
expect_error('coopdyn:wrong_data', @() r.set_velocity([1 2 3]), 'write r.set_velocity(0.2, 0.5)');
expect_error('coopdyn:wrong_data', @() r.set_wheel_speeds(2), 'write r.set_wheel_speeds(2, 3)');
expect_error('coopdyn:out_of_range', @() r.set_velocity([0.2 NaN]), 'w [rad/s]');
expect_error('coopdyn:wrong_params', @() r.get_target(), 'write r.get_target(''red'') or r.get_target(1)');
expect_error('coopdyn:wrong_params', @() r.send_message(), 'write r.send_message([1 0.5])');
expect_error('coopdyn:wrong_params', @() r.subscribe(), 'write r.subscribe(''distance'')');
expect_error('coopdyn:wrong_params', @() r.call('motors'), 'write r.call(''motors''');
expect_error('coopdyn:wrong_params', @() sim.robot(), 'write sim.robot(''robot1'') or sim.robot(1)');
expect_error('coopdyn:wrong_params', @() sim.load_scenario(), 'write sim.load_scenario(''corridor'')');
expect_error('coopdyn:wrong_params', @() sim.set_mode(), 'write sim.set_mode(''lockstep'')');
expect_error('coopdyn:wrong_params', @() sim.set_step(), 'write sim.set_step(0.01)');
expect_error('coopdyn:wrong_params', @() sim.set_speed(), 'write sim.set_speed(2)');
expect_error('coopdyn:wrong_params', @() sim.release_robot(), 'write sim.release_robot(''robot1'')');
expect_error('coopdyn:wrong_params', @() sim.snapshot(), 'write sim.snapshot(''a.png'')');
expect_error('coopdyn:wrong_params', @() sim.describe(), 'write sim.describe(''/robot1/motors'')');
expect_error('coopdyn:wrong_params', @() sim.call('/robot1/motors'), 'write sim.call(');
expect_error('coopdyn:wrong_params', @() sim.save_state(), 'write sim.save_state(''before_turn'')');
expect_error('coopdyn:wrong_params', @() sim.restore_state(), 'write sim.restore_state(');
expect_error('coopdyn:wrong_params', @() sim.note(), 'write sim.note(');
expect_error('coopdyn:wrong_params', @() sim.fetch_run(), 'write sim.fetch_run(''lesson1'')');
expect_error('coopdyn:wrong_params', @() sim.seek(), 'write sim.seek(12.5)');
expect_error('coopdyn:wrong_params', @() sim.set_play_speed(), 'write sim.set_play_speed(2)');
expect_error('coopdyn:wrong_params', @() sim.set_loop(), 'write sim.set_loop(true)');
expect_error('coopdyn:wrong_params', @() coopdyn.read_run(), 'write run = coopdyn.read_run(''lesson1.mat'')');
sim.close();
team_sim = coopdyn.connect();
while any(arrayfun(@(one) ~isempty(one.owner), team_sim.status().robots))  % the daemon must first notice that sim has gone
  pause(0.01);
end
team = team_sim.team();
expect_error('coopdyn:wrong_params', @() team.step_wheels(), 'write team.step_wheels([3 3])');
team.step([0.1 0], 'timeout', 60);
server = getenv('COOPDYN_SERVER');
port = str2double(regexprep(server, '.*:', ''));
setenv('COOPDYN_SERVER', '');
by_port = coopdyn.connect(port);
assert(numel(by_port.robots()) == 2);
by_text = coopdyn.connect(sprintf('%d', port));
assert(numel(by_text.robots()) == 2);
expect_error('coopdyn:out_of_range', @() coopdyn.connect(210000), 'a port of this machine');
disp('passed')

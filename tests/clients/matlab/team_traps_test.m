% SPDX-License-Identifier: MIT
% needs: fake --robots 3 --mode lockstep
% Running twice takes over; after an error, a timeout or Ctrl-C the next reply is the right one.
old_sim = coopdyn.connect();
old = old_sim.team();
s = old.step([0.5 0]);
sim = coopdyn.connect();
team = sim.team({'robot1', 'robot2'});
assert(isequal(team.names, {'robot1', 'robot2'}));
expect_error('coopdyn:owned', @() old.step([0.7 0]), 'no longer driven by this sim', 'sim.team()');
expect_error('coopdyn:owned', @() old.read());
old.close();
third = sim.robot('robot3');
s = team.step([0.1 0], 'timeout', 60);
assert(s.step == 2);
sim.call('/simulation', 'load_scenario', [], [], '!refuse=robot2');
expect_error('coopdyn:out_of_range', @() team.step([0.1 0], 'timeout', 60), 'robot2 is refused');
sim.call('/simulation', 'load_scenario', [], [], '!refuse=');
s = team.step([0.2 0], 'timeout', 60);
w = third.get_wheels();
% Two steps if robot3's command of the refused one was still there: the team catches up.
assert(s.step == sim.steps && any(abs(s.pose(1, 1) - [0.008 0.01]) < 1e-12));
alone_sim = coopdyn.connect('name', 'ana');
expect_error('coopdyn:owned', @() alone_sim.team('robot1'), 'team robot1 cannot be driven', 'robot1 is owned by');
sim.close();
alone = alone_sim.team({'robot1', 'robot2'});
s = alone.step([0 0], 'timeout', 60);  % robot3 has its stop, which closing wrote
expect_error('coopdyn:timed_out', @() alone.step([0.1 0], 'timeout', 0.1), 'robot3 (no client)');
third = alone_sim.robot('robot3');
s = alone.step([0.3 0], 'timeout', 60);
assert(s.step == alone_sim.steps && isequal(size(s.pose), [2 3]));
% A request whose reply nobody read, as after Ctrl-C: the next use reopens the connection.
a = coopdyn.internal.address('', 'ben', '', 3);
alone_sim.close();
session = coopdyn.internal.Session(a, false);
link = coopdyn.internal.take_team(session, 'robot1');
c = link.connection;
c.send(112, coopdyn.internal.encode(112, [], []));
assert(~c.idle);
reply = link.ask(session, 113);
assert(reply.command == 113 && isequal(reply.params, 1));
session.close();
disp('passed')

% SPDX-License-Identifier: MIT
% needs: fake --robots 2 --seat ana:0912
% A seat of a class: every connection takes it, files come from its page, errors have the class's text.
ana = {'', 'seat', 'ana', 'pin', '0912'};
sim = coopdyn.connect(ana{:});
r = sim.robot(1);
r.set_velocity(0.1, 0);
sim.step();
r.sense();
team = sim.team('robot2');
team.step([0.1 0]);
assert(~isempty(sim.modules()));
file = [tempname() '.run'];
remove = onCleanup(@() delete(file));
sim.fetch_run('lesson', file);
assert(strcmp(fileread(file), '/s/ana/runs/lesson.run'), fileread(file));
sim.snapshot(file);
assert(strncmp(fileread(file), '/s/ana/snapshot.png?', 20), fileread(file));
said = evalc('coopdyn.doctor(ana{:});');
assert(~isempty(strfind(said, 'seat: ana is yours')), said);
sim.close();

expect_error('coopdyn:not_allowed', @() coopdyn.connect('', 'seat', 'ana', 'pin', '0913'), 'no seat with this PIN');
expect_error('coopdyn:not_allowed', @() coopdyn.connect(), 'this is a class');
expect_error('coopdyn:not_allowed', @() coopdyn.internal.ask_names(coopdyn.internal.address('', '', '', 3)), 'this is a class');
how = 'write coopdyn.connect(''labserver'', ''seat'', ''ana'', ''pin'', ''7305'')';
expect_error('coopdyn:wrong_data', @() coopdyn.connect('', 'seat', 'ana'), 'the seat ''ana'' needs its PIN', how);
expect_error('coopdyn:wrong_data', @() coopdyn.connect('', 'pin', '0912'), 'a PIN needs its seat', how);
expect_error('coopdyn:wrong_data', @() coopdyn.connect('', 'seat', 'ana', 'pin', 912), 'loses the zeros', '''pin'', ''0912''');
for seat = {'Ana', '-ana', 'ana b', 5}
  expect_error('coopdyn:wrong_data', @() coopdyn.connect('', 'seat', seat{1}, 'pin', '0912'), 'only a-z, 0-9, - and _', how);
end
for pin = {'091', '09 12', repmat('1', 1, 17)}
  expect_error('coopdyn:wrong_data', @() coopdyn.connect('', 'seat', 'ana', 'pin', pin{1}), '4 to 16 letters or digits', how);
end
expect_error('coopdyn:out_of_range', @() coopdyn.connect('unix:/tmp/door'), 'by TCP only', 'write HOST:PORT');

setenv('COOPDYN_SEAT', 'ana:0912');
by_variable = coopdyn.connect();
assert(numel(by_variable.robots()) == 2);
setenv('COOPDYN_SEAT', 'ben:7305');
by_argument = coopdyn.connect(ana{:});
assert(numel(by_argument.robots()) == 2);
expect_error('coopdyn:not_allowed', @() coopdyn.connect(), 'no seat with this PIN');
expect_error('coopdyn:not_allowed', @() coopdyn.connect('', 'seat', ''), 'this is a class');
for half = {'ana', 'ana:', ':0912'}
  setenv('COOPDYN_SEAT', half{1});
  expect_error('coopdyn:wrong_data', @() coopdyn.connect(), 'needs its', 'COOPDYN_SEAT=ana:7305');
end
disp('passed')

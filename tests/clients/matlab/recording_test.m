% SPDX-License-Identifier: MIT
% needs: daemon classroom --mode lockstep
% A run is recorded, downloaded and read; a saved state is restored. Playback is in playing_test.
folder = tempname();
mkdir(folder);
cleanup = onCleanup(@() rmdir_all(folder));
sim = coopdyn.connect();
r = sim.robot('robot1');
assert(isempty(sim.recording()));
expect_error('coopdyn:not_possible', @() sim.stop_recording());
expect_error('coopdyn:not_possible', @() sim.playback(), 'coopdyn play');
expect_error('coopdyn:out_of_range', @() sim.record('no/name'));
assert(strcmp(sim.record('lesson1'), 'lesson1.run'));
now = sim.recording();
assert(strcmp(now.name, 'lesson1.run') && now.begin_time == 0);
seen = zeros(40, 3);
hashes = cell(40, 1);
for k = 1:40
  r.set_velocity(0.2, sin(0.1 * k));
  sim.step(1, 'timeout', 60);
  p = r.get_pose();
  seen(k, :) = [p.x p.y p.heading];
  hashes{k} = sim.hash();
end
distances = r.get_distances();
sim.note('the end');
[name, url] = sim.stop_recording();
assert(strcmp(name, 'lesson1.run') && ~isempty(regexp(url, '^http://127\.0\.0\.1:\d+/runs/lesson1\.run$', 'once')));
files = sim.recordings();
assert(isequal(size(files), [1 1]) && strcmp(files.name, name) && files.steps == 40 && ~files.recording && strcmp(files.url, url));
mat = sim.fetch_run('lesson1', fullfile(folder, 'lesson1.mat'));
recording = sim.fetch_run('lesson1', fullfile(folder, 'copy.run'));
expect_error('coopdyn:no_such_name', @() sim.fetch_run('never', fullfile(folder, 'x.mat')));
assert(numel(dir(folder)) == 4);  % with . and ..

run = coopdyn.read_run(mat);
assert(isequal(run.names, {'robot1'}) && isequal(run.steps, (0:40)') && isequal(run.hash(2:end), hashes));
pose = run.pose('robot1');
assert(isequal(size(pose), [41 3]) && max(max(abs(pose(2:end, :) - seen))) < 5e-6);
d = run.reading('robot1', 'distances');
near = isfinite(distances);
assert(isequal(isinf(d(end, :)), ~near) && max(abs(d(end, near) - distances(near))) < 1e-5);
c = run.commands('robot1');
assert(isequal(c(:, 1), (0:40)') && all(c(2:end, 3) ~= 0));
assert(strcmp(run.events(end).text, 'the end') && strcmp(run.events(end).level, 'note') && run.events(end).step == 40);
assert(~isempty(strfind(run.scenario, '[ROBOT')));

setenv('COOPDYN', getenv('COOPDYN_BINARY'));
again = coopdyn.read_run(recording);  % by way of coopdyn export
assert(isequal(again.time, run.time) && isequal(again.hash, run.hash) && isequaln(again.pose('robot1'), pose));
assert(isequaln(again.reading('robot1', 'targets'), run.reading('robot1', 'targets')));

csv = fullfile(folder, 'lesson1.csv');
assert(system(['"' getenv('COOPDYN_BINARY') '" export "' recording '" --to csv --out "' csv '" > ' fullfile(folder, 'log') ' 2>&1']) == 0);
f = fopen(csv);
head = strsplit(strtrim(fgetl(f)), ',');
rows = textscan(f, repmat('%s', 1, numel(head)), 'Delimiter', ',');  % its %f is not exact to the last digit
fclose(f);
column = @(name) str2double(rows{strcmp(head, name)});
assert(isequal(rows{end}, run.hash) && isequal(column('time_s'), run.time));
assert(isequal([column('robot1.x_m') column('robot1.y_m') column('robot1.heading_rad')], pose));
assert(isequal(column('robot1.d11_m'), d(:, 11)));
j = strcat('robot1.', run.joints('robot1'));
of = @(word) [column([j{1} word]) column([j{2} word])];
assert(isequal([of('_rad') of('_rad_s')], run.reading('robot1', 'channels')));
assert(isequal(of('_setpoint_rad_s'), c(:, 3:4)) && all(all(c(:, 5:6) == 3)));
b = run.pose_3d('BALL_1');
assert(isequal(column('BALL_1.z_m'), b(:, 3)));

sim.save_state('here');
states = sim.saved_states();
assert(any(strcmp({states.name}, 'here')) && abs(states(strcmp({states.name}, 'here')).time - 0.4) < 1e-9);
for round = 1:2
  for k = 1:5
    r.set_velocity(0.1, -1);
    sim.step(1, 'timeout', 60);
  end
  last{round} = sim.hash();
  sim.restore_state('here');
  assert(sim.steps == 40 && strcmp(sim.hash(), hashes{40}));
end
assert(strcmp(last{1}, last{2}));
sim.open_run('lesson1');
assert(strcmp(sim.playback().file, 'lesson1.run'));
sim.close_run();
assert(strcmp(sim.hash(), hashes{40}));
expect_error('coopdyn:not_possible', @() sim.close_run());
expect_error('coopdyn:no_such_name', @() sim.restore_state('never'));
ben = coopdyn.connect('name', 'ben');
ben.release_robot('robot1');
mine = ben.robot('robot1');
mine.set_velocity(0.1, 0);
ben.close();
sim.close();
disp('passed')

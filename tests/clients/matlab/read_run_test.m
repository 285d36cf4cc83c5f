% SPDX-License-Identifier: MIT
% needs: nothing
% Reads the output of coopdyn export --to mat; a file that is not a recording is an error.
folder = tempname();
mkdir(folder);
cleanup = onCleanup(@() rmdir_all(folder));
file = fullfile(folder, 'by hand.mat');
half = sqrt(0.5);
robots = struct('name', {'robot1', 'robot2'}, 'type', 'coopbot', 'pose', {[0 0 0; 1 2 0.5], [NaN NaN NaN; 3 4 -0.5]}, ...
                'pose_3d', {[0 0 0 1 0 0 0; 1 2 0 half 0 0 half], ones(2, 7)}, 'joints', {{'left_joint', 'right_joint'}}, ...
                'channels', {[0 0 0 0; 1 -1 2 3], zeros(0, 0)}, 'setpoints', {[0 0; 2 3], [0 0; 0 0]}, 'modes', 3 * ones(2, 2), 'distances', {[1 Inf 2; 3 4 5], zeros(2, 0)}, ...
                'targets', {[1 0.5; NaN NaN], [2 0; 2 0]}, 'commands', {[0 0 0 0 3 3; 1 0.01 2 3 3 1], zeros(0, 6)});
objects = struct('name', {'BOX_1'}, 'pose_3d', {[1 1 1 1 0 0 0; 2 1 1 half 0 0 half]});
run = struct('file', 'x.run', 'scenario', sprintf('[FLOOR]\nsize 4 4 0.1\n'), 'seed', 7, 'version', '0.1.0', ...
             'time', [0; 0.01], 'step', [0; 1], 'names', {{'robot1', 'robot2'}}, ...
             'hash', ['00000000000000ab'; '1234567890abcdef'], 'robots', robots, 'objects', objects, ...
             'targets', struct('color', 'red', 'x', 1, 'y', 2, 'z', 0), ...
             'events', struct('step', {0, 1}, 'time_s', {0, 0.01}, 'level', {'info', 'note'}, 'text', {'start', 'here'}));
save('-mat', file, 'run');
r = coopdyn.read_run(file);
assert(isequal(r.file, file) && isequal(r.names, {'robot1', 'robot2'}));
assert(isequal(r.time, [0; 0.01]) && isequal(r.steps, [0; 1]) && strcmp(r.scenario, run.scenario));
assert(isequal(r.hash, {'00000000000000ab'; '1234567890abcdef'}));
assert(r.info.seed == 7 && strcmp(r.info.version, '0.1.0'));
assert(isequal(r.pose('robot1'), [0 0 0; 1 2 0.5]) && isequaln(r.pose('robot2')(1, :), [NaN NaN NaN]));
assert(isequal(size(r.pose_3d('robot1')), [2 7]));
p = r.pose('BOX_1');
assert(isequal(p(:, 1:2), [1 1; 2 1]) && max(abs(p(:, 3) - [0; pi / 2])) < 1e-12);
assert(isequal(r.reading('robot1', 'distances'), [1 Inf 2; 3 4 5]));
assert(isequal(size(r.reading('robot2', 'distances')), [2 0]));
assert(isequaln(r.reading('robot1', 'targets'), [1 0.5; NaN NaN]) && isequal(r.reading('robot1', 'channels'), [0 0 0 0; 1 -1 2 3]));
assert(isequal(r.joints('robot1'), {'left_joint', 'right_joint'}));
assert(isequal(r.commands('robot1'), [0 0 0 0 3 3; 1 0.01 2 3 3 1]) && isempty(r.commands('robot2')));
assert(isequal({r.events.level}, {'info', 'note'}) && r.events(2).time == 0.01);
expect_error('coopdyn:no_such_name', @() r.pose('robot3'), 'robot1, robot2');
expect_error('coopdyn:no_such_name', @() r.pose('box_1'), 'did you mean BOX_1? there are: robot1, robot2, BOX_1');
expect_error('coopdyn:no_such_name', @() r.commands('BOX_1'), 'no robot');
expect_error('coopdyn:out_of_range', @() r.reading('robot1', 'smell'), 'distances, targets, channels');
expect_error('coopdyn:not_possible', @() r.reading('robot2', 'channels'), '--record-what');
run.robots = robots(1);  % a run of one robot
run.names = {'robot1'};
run.events = struct('step', {}, 'time_s', {}, 'level', {}, 'text', {});
run.objects = struct('name', {}, 'pose_3d', {});
save('-mat', file, 'run');
r = coopdyn.read_run(file);
assert(isempty(r.events) && isequal(r.pose('robot1'), [0 0 0; 1 2 0.5]));
expect_error('coopdyn:no_such_name', @() r.pose('BOX_1'), 'robot1');

expect_error('coopdyn:no_such_name', @() coopdyn.read_run(fullfile(folder, 'none.mat')), 'none.mat');
run.robots = rmfield(robots, 'channels');  % of an older version
save('-mat', file, 'run');
expect_error('coopdyn:malformed', @() coopdyn.read_run(file), 'robots.channels', 'coopdyn export');
run = struct('time', 1);
save('-mat', file, 'run');
expect_error('coopdyn:malformed', @() coopdyn.read_run(file), 'lacks', 'robots');
f = fopen(file, 'w');
fprintf(f, 'something else');
fclose(f);
expect_error('coopdyn:malformed', @() coopdyn.read_run(file), 'coopdyn export');
recording = fullfile(folder, 'lesson1.run');
copyfile(file, recording);
setenv('COOPDYN', fullfile(folder, 'no program'));
expect_error('coopdyn:not_possible', @() coopdyn.read_run(recording), 'setenv', 'coopdyn export', 'sim.fetch_run');
setenv('COOPDYN', getenv('COOPDYN_BINARY'));
expect_error('coopdyn:malformed', @() coopdyn.read_run(recording), 'lesson1.run');
disp('passed')

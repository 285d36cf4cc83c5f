% SPDX-License-Identifier: MIT
% needs: fake --mode lockstep
% A recording may have any name that a file can have.
folder = tempname();
mkdir(folder);
cleanup = onCleanup(@() rmdir_all(folder));
sim = coopdyn.connect();
name = ['my lesson ' native2unicode(uint8([195 188]), 'UTF-8')];
assert(strcmp(sim.record(name), [name '.run']));
[ended, url] = sim.stop_recording();
assert(strcmp(ended, [name '.run']) && ~isempty(regexp(url, ':\d+/runs/my%20lesson%20%C3%BC\.run$', 'once')));
for kind = {'.run', '.mat'}
  file = sim.fetch_run(name, fullfile(folder, ['copy' kind{1}]));
  f = fopen(file);
  said = fread(f, [1 Inf], '*uint8');
  fclose(f);
  assert(isequal(native2unicode(said, 'UTF-8'), ['/runs/' name kind{1}]));
end
for wrong = {'', '  ', 7}
  expect_error('coopdyn:wrong_data', @() sim.fetch_run(wrong{1}), 'the name of a recording is a text');
end
sim.load_scenario('!page=0');
sim.record(name);
[ended, url] = sim.stop_recording();
assert(strcmp(ended, [name '.run']) && isempty(url));
sim.close();
disp('passed')

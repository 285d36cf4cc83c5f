% SPDX-License-Identifier: MIT
% needs: nothing
text = sprintf('[SIMULATION]\nmode lockstep\n[ROBOT_1]\ntype coopbot\nname ana\nposition 0 0\n');
function process = daemon_of(program)
  [~, said] = system(sprintf('pgrep -f -- "[-]-with-process.%d( |$)"', program));
  process = sscanf(said, '%d', 1);
end
folder = tempname();  % private, because other tests run meanwhile
mkdir(folder);
cleanup = onCleanup(@() rmdir_all(folder));
setenv('TMPDIR', folder);

sim = coopdyn.launch(text, 'set', {'ROBOT_1.position', [1 2], 'SCORE_1.kind', 'distance'}, 'seed', 7, 'options', {'--no-http'});
r = sim.robot('ana');
p = r.get_pose();
assert(isequal([p.x p.y], [1 2]));
s = sim.status();
assert(s.seed == 7 && isequal(sim.scores(), struct('distance', 0)));
r.set_velocity(0.2, 0);
sim.step(10);
assert(sim.steps == 10);
process = daemon_of(getpid());
assert(coopdyn.internal.is_running(process));
sim.close();
assert(~coopdyn.internal.is_running(process));
sim.close();

sim = coopdyn.launch('classroom', 'mode', 'free');
s = sim.status();
assert(strcmp(s.scenario, 'classroom') && strcmp(sim.mode, 'free'));
sim.close();

function id = raised(varargin)
  id = '';
  try
    coopdyn.launch(varargin{:});
  catch failed
    id = [failed.identifier ' ' failed.message];
  end
end
assert(~isempty(strfind(raised(strrep(text, 'coopbot', 'cooopbot')), 'did you mean ''coopbot''?')));
assert(~isempty(strfind(raised('classroom', 'program', '/nowhere/coopdyn'), '/nowhere/coopdyn')));
assert(strncmp(raised(7), 'coopdyn:wrong_data', 18));
assert(strncmp(raised('classroom', 'sed', 7), 'coopdyn:wrong_params', 20));

% A program that ends without close leaves no daemon.
command = sprintf(['octave --no-gui --norc --eval "addpath(''%s''); sim = coopdyn.launch(''classroom''); ' ...
                   'system(sprintf(''pgrep -f -- \\"[-]-with-process.%%d( |$)\\"'', getpid())); fflush(stdout); kill(getpid(), 9)" 2>/dev/null'], ...
                  fullfile(getenv('COOPDYN_ROOT'), 'clients', 'matlab'));
[~, said] = system(command);
process = sscanf(said, '%d', 1);
assert(process > 0);
began = tic();
while coopdyn.internal.is_running(process)
  assert(toc(began) < 60);
  pause(0.01);
end

assert(numel(dir(folder)) == 2, 'files are left');  % . and ..
disp('passed');

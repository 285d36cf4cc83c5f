% SPDX-License-Identifier: MIT
function run = read_run(file)
%READ_RUN Reads a recorded run: run = coopdyn.read_run('lesson1.mat'), as downloaded by sim.fetch_run.
%   run.time (k x 1), run.names, run.pose('robot1') (k x 3: x y heading), run.pose_3d(name), run.reading('robot1',
%   'distances'), run.joints('robot1'), run.commands('robot1'), run.events, run.hash, run.steps, run.scenario, run.info; see coopdyn.Run.
%   A recording lesson1.run itself is read by the program coopdyn on this machine: on the path, or named by the environment
%   variable COOPDYN.
  coopdyn.internal.need(nargin, 1, 'run = coopdyn.read_run(''lesson1.mat'')');
  run = coopdyn.Run(load_run(coopdyn.internal.run_name(file)));
end

function s = load_run(file)
% The struct that `coopdyn export --to mat` writes for a recorded run; exports a recording first.
  if exist(file, 'file') ~= 2
    coopdyn.internal.fail(10, ['there is no file ''' file '''; a recording is called NAME.run, and NAME.mat as MATLAB reads it']);
  end
  [~, ~, kind] = fileparts(file);
  mat = file;
  if ~strcmpi(kind, '.mat')
    mat = [tempname() '.mat'];
    cleanup = onCleanup(@() remove(mat));
    export(file, mat);
  end
  try
    loaded = load(mat);
    s = loaded.run;
    missing = setdiff({'time', 'step', 'names', 'hash', 'robots', 'objects', 'events', 'scenario'}, fieldnames(s));
    if isempty(missing) && ~isempty(s.robots)
      missing = strcat('robots.', setdiff({'joints', 'channels', 'modes'}, fieldnames(s.robots)));
    end
  catch
    coopdyn.internal.fail(7, [file ' is no recording of coopdyn as a MAT file: `coopdyn export NAME.run --to mat` makes one']);
  end
  if ~isempty(missing)
    coopdyn.internal.fail(7, [file ' is no recording of coopdyn as a MAT file: it lacks ' ...
      strjoin(missing, ', ') ': `coopdyn export NAME.run --to mat` makes one']);
  end
  s.file = file;
end

function export(file, mat)
  program = getenv('COOPDYN');
  if isempty(program)
    program = 'coopdyn';
  end
  clean = '';
  if isunix()
    clean = 'umask 077; ';  % the file is in a folder shared by all users
  end
  if isunix() && ~coopdyn.internal.is_octave()
    clean = [clean 'LD_LIBRARY_PATH= '];  % MATLAB's own libraries must not be loaded
  end
  [status, said] = system([clean '"' program '" export "' file '" --to mat --out "' mat '" 2>&1']);
  if status == 0
    return
  end
  if status == 127 || status == 9009 || (ispc() && exist(mat, 'file') ~= 2 && isempty(strfind(said, file)))
    coopdyn.internal.fail(5, ['to read a recording the program coopdyn is needed: name it, e.g. setenv(''COOPDYN'', ' ...
      '''/opt/coopdyn/coopdyn''), or make ' regexprep(file, '\.run$', '.mat') ' where it is with `coopdyn export ' file ...
      ' --to mat` (sim.fetch_run copies a run from the daemon as one), and read that']);
  end
  coopdyn.internal.fail(7, strtrim(said));
end

function remove(mat)
  if exist(mat, 'file') == 2
    delete(mat);
  end
end

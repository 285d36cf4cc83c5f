% SPDX-License-Identifier: MIT
function sim = launch(scenario, varargin)
%LAUNCH Starts a private daemon on free ports of this machine and connects to it.
%   sim = coopdyn.launch('classroom')                  a scenario's name or file
%   sim = coopdyn.launch(sprintf('[ROBOT_1]\n...'))     or its text
%   sim = coopdyn.launch('arena20', 'seed', 7, 'mode', 'free', 'record', 'a.run', 'set', {'SWARM_1.count', 20})
%   set: overrides of the scenario's values, in pairs.   options: further arguments of `coopdyn serve`, {'--no-http'}.
%   program: the program coopdyn, if it is neither on the PATH nor named by setenv('COOPDYN', ...).
%   timeout: seconds until the daemon is ready.
%   The daemon exits on sim.close(), and when this MATLAB or Octave exits or crashes.
  if nargin < 1
    scenario = 'classroom';
  end
  if ~coopdyn.internal.is_text(scenario)
    coopdyn.internal.fail(3, 'a scenario is a file, a name or a text; write e.g. coopdyn.launch(''classroom'')');
  end
  if ~isunix()
    coopdyn.internal.fail(5, 'the daemon runs on Linux: start it there with `coopdyn serve`, and use coopdyn.connect');
  end
  known = struct('set', {{}}, 'seed', [], 'mode', '', 'record', '', 'options', {{}}, 'program', '', 'timeout', 60);
  o = coopdyn.internal.options(varargin, known);
  if ~iscell(o.set) || mod(numel(o.set), 2) ~= 0
    coopdyn.internal.fail(2, 'set takes pairs of a key and its value, e.g. ''set'', {''SWARM_1.count'', 20}');
  end
  if size(o.set, 2) == 2
    o.set = o.set';  % one row per pair
  end
  scenario = char(scenario);
  base = tempname();
  files = {[base '.scenario'], [base '.out'], [base '.err']};
  remove = onCleanup(@() cellfun(@forget, files));
  words = {scenario};
  input = '/dev/null';
  if any(scenario == 10)
    f = fopen(files{1}, 'w');
    fwrite(f, scenario);
    fclose(f);
    words = {'-'};
    input = files{1};
  end
  words = [words, {'--port', '0', '--with-process', sprintf('%d', own_number())}];
  for k = 1:2:numel(o.set)
    words = [words, {'--set', [char(o.set{k}) '=' as_text(o.set{k + 1})]}];
  end
  flags = {'seed', 'mode', 'record'};
  for k = 1:numel(flags)
    value = o.(flags{k});
    if ~isempty(value)
      words = [words, {['--' flags{k}], as_text(value)}];
    end
  end
  words = [words, reshape(cellstr(o.options), 1, [])];
  command = strjoin(cellfun(@quoted, [{program_of(o.program), 'serve'}, words], 'UniformOutput', false), ' ');
  clean = '';
  if ~coopdyn.internal.is_octave()
    clean = 'LD_LIBRARY_PATH= ';  % MATLAB's own libraries must not be loaded
  end
  % In a separate session: Ctrl-C must reach only the program.
  [~, said] = system(sprintf('%ssetsid %s <%s >%s 2>%s & echo $!', clean, command, quoted(input), quoted(files{2}), quoted(files{3})));
  process = str2double(said);
  server = wait_for(process, files, o.timeout);
  try
    sim = coopdyn.Simulation(struct('server', server, 'name', '', 'token', '', 'timeout', 3, 'watch', false, ...
                                    'seat', '', 'pin', '', 'process', process));
  catch failed
    coopdyn.internal.end_process(process);
    rethrow(failed);
  end
end

function server = wait_for(process, files, timeout)
% Waits until the daemon is ready; returns its address.
  began = tic();
  while true
    ended = ~coopdyn.internal.is_running(process);
    at = regexp(content(files{2}), '^ready names=(\S+) ', 'tokens', 'once', 'lineanchors');
    if ~isempty(at)
      server = at{1};
      return
    end
    if ended
      coopdyn.internal.fail(7, sprintf('the daemon did not start:\n%s', strtrim(content(files{3}))));
    end
    if toc(began) > timeout
      coopdyn.internal.end_process(process);
      coopdyn.internal.fail(11, sprintf('the daemon was not ready within %g s: give launch a longer timeout', timeout));
    end
    pause(0.01);
  end
end

function text = content(file)
  text = '';
  f = fopen(file);
  if f >= 0
    text = fread(f, [1 Inf], '*char');
    fclose(f);
  end
end

function forget(file)
  if exist(file, 'file') == 2
    delete(file);
  end
end

function text = as_text(value)
% A value in a scenario's syntax: 20, '>= 3', [1 2].
  if isnumeric(value) || islogical(value)
    text = strtrim(sprintf('%.17g ', value));
  else
    text = char(value);
  end
end

function text = quoted(word)
  text = ['''' strrep(char(word), '''', '''\''''') ''''];
end

function program = program_of(given)
  program = char(given);
  for name = {'COOPDYN', 'COOPDYN_BINARY'}
    if isempty(program)
      program = getenv(name{1});
    end
  end
  if isempty(program)
    program = 'coopdyn';
  end
end

function number = own_number()
  if coopdyn.internal.is_octave()
    number = getpid();
  else
    number = feature('getpid');
  end
end

% SPDX-License-Identifier: MIT
function run = read_run(file)
%READ_RUN Reads a recorded run: run = coopdyn.read_run('lesson1.mat'), as sim.fetch_run copies it from the daemon.
%   run.time (k x 1), run.names, run.pose('robot1') (k x 3: x y heading), run.pose_3d(name), run.reading('robot1',
%   'distances'), run.commands('robot1'), run.events, run.hash, run.steps, run.scenario, run.info; see coopdyn.Run.
%   A recording itself, lesson1.run, is read with the program coopdyn on this machine: on the path, or named by the
%   environment variable COOPDYN.
  coopdyn.internal.need(nargin, 1, 'run = coopdyn.read_run(''lesson1.mat'')');
  run = coopdyn.Run(coopdyn.internal.load_run(coopdyn.internal.run_name(file)));
end

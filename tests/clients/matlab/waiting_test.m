% SPDX-License-Identifier: MIT
% needs: fake --robots 2 --mode lockstep
% A step that waits says once after 2 s whom for, and goes on when its time is over.
sim = coopdyn.connect();
sim.robot(1);
said = evalc('try, sim.step(1, ''timeout'', 2.5), catch cause, disp(cause.identifier), end');
assert(~isempty(strfind(said, 'coopdyn:timed_out')));
disp('passed')

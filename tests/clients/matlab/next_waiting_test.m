% SPDX-License-Identifier: MIT
% needs: daemon formation --mode lockstep
% next with nobody stepping says once after 2 s whom for; of many robots four are named.
% prints once: coopdyn: waiting for robot1
sim = coopdyn.connect();
expect_error('coopdyn:timed_out', @() sim.step(1, 'timeout', 0.2), ' s and 1 more');
r = sim.robot(1);
r.subscribe('pose');
expect_error('coopdyn:timed_out', @() r.next('timeout', 12), 'robot2 (no client)');
disp('passed')

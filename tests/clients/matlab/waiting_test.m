% SPDX-License-Identifier: MIT
% needs: fake --robots 2 --mode lockstep
% A waiting step reports once after 2 s whom it waits for, and times out.
% prints once: coopdyn: waiting for
sim = coopdyn.connect();
sim.robot(1);
expect_error('coopdyn:timed_out', @() sim.step(1, 'timeout', 12), 'robot2 (no client)');
disp('passed')

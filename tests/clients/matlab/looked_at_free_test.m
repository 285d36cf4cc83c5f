% SPDX-License-Identifier: MIT
% needs: recording classroom --duration 0.6
% A robot that was only read and is free after a branch steps with the program.
sim = coopdyn.connect('name', 'ana');
sim.pause();
r = sim.robot('robot1');
sim.branch(0.3);
sim.set_mode('lockstep');
sim.run();
sim.step(3, 'timeout', 60);
status = sim.status();
assert(sim.steps == 33 && strcmp(status.robots.owner, 'ana'));
sim.close();
disp('passed')

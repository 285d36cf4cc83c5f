% SPDX-License-Identifier: MIT
% needs: fake --robots 2
% clear all frees the sockets and with them the robots.
before = sockets();
sim = coopdyn.connect();
r = sim.robot(1);
r.get_pose();
r.sense();
r.subscribe('pose');
assert(sockets() >= before + 4);
save_before = before;
clear sim
r.get_pose();  % a robot works on without its sim
setenv('SOCKETS_BEFORE', num2str(save_before));
clear all
assert(sockets() == str2double(getenv('SOCKETS_BEFORE')));
sim = coopdyn.connect('name', 'another');
sim.robot(1);
disp('passed')

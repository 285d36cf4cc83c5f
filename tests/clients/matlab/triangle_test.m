% SPDX-License-Identifier: MIT
% needs: daemon triangle --mode lockstep
assert(formation('robot1', 'robot2', 'robot3'));
disp('passed')

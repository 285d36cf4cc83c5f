% SPDX-License-Identifier: MIT
% needs: daemon triangle --mode lockstep --step 0.04
assert(formation('robot1', 'robot2', 'robot3'));
disp('passed')

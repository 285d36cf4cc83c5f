% SPDX-License-Identifier: MIT
% needs: daemon classroom --mode realtime --speed 2
assert(attractor('robot1'));
disp('passed')

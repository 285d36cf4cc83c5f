% SPDX-License-Identifier: MIT
% needs: daemon fig4 --mode realtime --speed 3
assert(attractor('robot1'));
disp('passed')

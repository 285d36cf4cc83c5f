% SPDX-License-Identifier: MIT
% needs: daemon box_maze --mode lockstep
assert(attractor());
disp('passed')

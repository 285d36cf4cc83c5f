% SPDX-License-Identifier: MIT
% needs: daemon formation --mode lockstep
assert(formation());
disp('passed')

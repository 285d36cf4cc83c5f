% SPDX-License-Identifier: MIT
% needs: daemon formation --mode lockstep --step 0.04
assert(formation());
disp('passed')

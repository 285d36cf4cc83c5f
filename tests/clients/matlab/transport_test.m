% SPDX-License-Identifier: MIT
% needs: daemon transport --mode lockstep --step 0.04
assert(transport());
disp('passed')

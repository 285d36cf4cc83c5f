% SPDX-License-Identifier: MIT
% needs: daemon transport --mode lockstep
assert(transport());
disp('passed')

% SPDX-License-Identifier: MIT
% needs: daemon classroom --mode lockstep
run(fullfile(getenv('COOPDYN_ROOT'), 'clients', 'matlab', 'hello.m'));
assert(hypot(p.x - 1.5, p.y - 0.5) < 0.45);
disp('passed')

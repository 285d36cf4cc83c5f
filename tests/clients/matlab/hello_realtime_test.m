% SPDX-License-Identifier: MIT
% needs: daemon classroom --mode realtime --speed 4
run(fullfile(getenv('COOPDYN_ROOT'), 'clients', 'matlab', 'hello.m'));
assert(hypot(p.x - 1.5, p.y - 0.5) < 0.6);
disp('passed')

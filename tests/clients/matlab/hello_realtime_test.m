% SPDX-License-Identifier: MIT
% needs: daemon classroom --mode realtime --speed 2
run(fullfile(getenv('COOPDYN_ROOT'), 'clients', 'matlab', 'hello.m'));
assert(t.distance < 0.4);  % its later position depends on the machine
disp('passed')

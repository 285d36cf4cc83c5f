% SPDX-License-Identifier: MIT
% needs: daemon swarm100 --no-http --no-render
run(fullfile(getenv('COOPDYN_ROOT'), 'clients', 'matlab', 'swarm.m'));
assert(s.step == 1000 && mean(gone) > 0.3);
disp('passed')

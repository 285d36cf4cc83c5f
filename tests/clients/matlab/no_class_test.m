% SPDX-License-Identifier: MIT
% needs: fake
% A seat requested from an ordinary daemon; without a seat, the same daemon answers.
expect_error('coopdyn:not_possible', @() coopdyn.connect('', 'seat', 'ana', 'pin', '0912'), 'is not a class: leave seat and pin out');
setenv('COOPDYN_SEAT', 'ana:0912');
expect_error('coopdyn:not_possible', @() coopdyn.connect(), 'is not a class', 'and COOPDYN_SEAT, too');
sim = coopdyn.connect('', 'seat', '');
assert(numel(sim.robots()) == 1);
disp('passed')

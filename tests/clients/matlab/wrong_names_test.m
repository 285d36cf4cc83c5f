% SPDX-License-Identifier: MIT
% needs: daemon classroom
% A wrong robot or module is an error no_such_name with the daemon's hint, and the sim stays usable.
sim = coopdyn.connect();
r = sim.robot(1);
expect_error('coopdyn:no_such_name', @() sim.describe('/robot9/motors'), 'did you mean /robot1/motors');
expect_error('coopdyn:no_such_name', @() sim.call('/robot1/moters', 'stop'), 'did you mean /robot1/motors');
expect_error('coopdyn:no_such_name', @() r.subscribe('distanc'), 'did you mean /robot1/distance');
expect_error('coopdyn:no_such_name', @() sim.robot('robot9'), 'there are: robot1');
r.set_velocity(0.1, 0);
sim.step();
disp('passed')

% SPDX-License-Identifier: MIT
% needs: fake --mode lockstep
% The same program twice in one session, the first without close: the second takes over, the first gets an error.
sim = coopdyn.connect();
r = sim.robot('robot1');
old_sim = sim;
old = r;
sim = coopdyn.connect();
r = sim.robot('robot1');
r.set_velocity(0.1, 0);
sim.step();
old.set_velocity(0.5, 0);
expect_error('coopdyn:owned', @() old_sim.step(), 'no longer driven by this sim', 'sim.robot(''robot1'')');
expect_error('coopdyn:owned', @() old.set_velocity(0.5, 0));
sim.step();
old_sim.close();
sim.step();
p = r.get_pose();
assert(p.forward == 0.1);
expect_error('coopdyn:owned', @() connect_as('ben'), 'cannot be driven', 'watch');
disp('passed')

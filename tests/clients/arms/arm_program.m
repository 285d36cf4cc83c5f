% SPDX-License-Identifier: MIT
% Moves an arm in every way and prints its readings; arm_program.py and arm_program.cc are the same program.
1;
function show(what, values)
  disp([what sprintf(' %.17g', values)]);
end

sim = coopdyn.connect();
arm = sim.robot('arm1').joints('arm');
arm.set_positions([0 0.4 0 0.4 0 0.4 0]);
sim.step();
steps = 1;
while ~arm.arrived()
  sim.step();
  steps = steps + 1;
end
now = arm.get();
show('arrived', [steps now.position]);
motion = arm.get_motion();
show('target', motion.target);
arm.set_velocities([0.2 -0.1], [1 3]);
sim.step(50);
now = arm.get();
show('velocities', now.velocity);
arm.set_efforts(1.5, 'joint_7');
sim.step(5);
now = arm.get([6 7]);
show('efforts', now.effort);
disp(strjoin([{'modes'} arm.get_modes()], ' '));
arm.hold();
sim.step(30);
now = arm.get();
show('held', now.position);
arm.set_compliance(200, 20, 1, 2);
sim.step(100);
compliance = arm.get_compliance(2);
show('compliance', [compliance.k compliance.d compliance.offset]);
now = arm.get(2);
show('sagged', now.position);
for k = 0:19
  arm.set_positions_direct(0.4 + 0.001 * k, 4);
  sim.step();
end
now = arm.get(4);
show('direct', [arm.get_references(4) now.position]);
pose = arm.forward([0.1 0.2 0.3 0.4 0.5 0.6 0.7]);
show('tool', pose(1:3, 4)');
disp(['hash ' sim.hash() sprintf(' %d', sim.steps)]);
sim.close();

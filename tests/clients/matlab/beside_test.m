% SPDX-License-Identifier: MIT
% needs: daemon formation --mode lockstep
% Robots that take no part in lockstep set off no step of their own, and their commands run.
sim = coopdyn.connect();
robots = {sim.robot(1), sim.robot(2), sim.robot(3)};
for participants = {{'robot1'}, {'robot1', 'robot3'}, {'robot2'}}
  sim.set_participants(participants{1});
  sim.step();  % a command that came after the last step may have run already
  poses = cellfun(@(r) r.get_pose(), robots);
  for i = 1:20
    before = sim.steps;
    cellfun(@(r) r.set_velocity(0.2, 0.05), robots);
    sim.step();
    assert(sim.steps, before + 1);
  end
  moved = arrayfun(@(now, was) hypot(now.x - was.x, now.y - was.y), cellfun(@(r) r.get_pose(), robots), poses);
  assert(all(moved > 0.01));
end
disp('passed')

% SPDX-License-Identifier: MIT
% needs: daemon formation --mode lockstep
% Robots that do not participate in lockstep trigger no steps, and their commands run.
sim = coopdyn.connect();
robots = {sim.robot(1), sim.robot(2), sim.robot(3)};
for participants = {{'robot1'}, {'robot1', 'robot3'}, {'robot2'}}
  sim.set_participants(participants{1});
  sim.step();  % a command that came after the last step may have run already
  poses = cellfun(@(r) r.get_pose(), robots);
  made = 0;
  moved = 0;
  % Lockstep does not wait for the others: their commands run some steps later on a busy machine.
  while made < 20 || moved < numel(robots)
    before = sim.steps;
    cellfun(@(r) r.set_velocity(0.2, 0.05), robots);
    sim.step();
    made = made + 1;
    assert(sim.steps, before + 1);
    if moved < numel(robots)
      now = robots{moved + 1}.get_pose();
      moved = moved + (hypot(now.x - poses(moved + 1).x, now.y - poses(moved + 1).y) > 0.01);
    end
  end
end
disp('passed')

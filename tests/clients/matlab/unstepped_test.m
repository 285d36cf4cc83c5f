% SPDX-License-Identifier: MIT
% needs: fake --mode lockstep
% prints once: coopdyn: 200 commands to robot1 without a step, nothing moves: write sim.step() at the end of your loop
% A loop that never steps gets one notice, one that steps gets none.
good = coopdyn.connect('name', 'good');
r = good.robot(1);
for k = 1:3
  for j = 1:100
    r.set_velocity(0.1, 0);
  end
  good.step('timeout', 60);
end
good.close();
sim = coopdyn.connect('name', 'bad');
for k = 1:6000  % close does not wait: the robot is free soon
  try
    r = sim.robot(1);
    break
  catch
    pause(0.01);
  end
end
for k = 1:600
  r.set_velocity(0.1, 0);
end
disp('passed')

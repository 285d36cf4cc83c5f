% SPDX-License-Identifier: MIT
% needs: fake --mode lockstep --dribble
% Replies that arrive byte by byte are complete.
sim = coopdyn.connect();
r = sim.robot(1);
for k = 1:3
  s = r.sense('red');
  assert(numel(s.distances) == 11 && s.step == k - 1);
  assert(strcmp(s.target.colour, 'red'));
  r.set_velocity(0.1, 0);
  sim.step();
end
disp('passed')

% SPDX-License-Identifier: MIT
% needs: daemon classroom --mode realtime
% A mode switch by another client neither hangs nor spins the loop.
sim = coopdyn.connect();
teacher = coopdyn.connect('name', 'teacher');
r = sim.robot(1);
for mode = {'lockstep', 'realtime', 'free', 'lockstep'}
  teacher.set_mode(mode{1});
  last = -1;
  for k = 1:4
    r.set_velocity(0.1, 0);
    sim.step('timeout', 60);
    assert(sim.steps > last);
    last = sim.steps;
  end
  assert(strcmp(sim.mode, mode{1}));
end
disp('passed')

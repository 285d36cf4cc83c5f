% SPDX-License-Identifier: MIT
% needs: daemon formation --mode lockstep
% Five robots in one process do not deadlock, and repeat themselves after a reset.
sim = coopdyn.connect();
robots = cell(1, 5);
for k = 1:5
  robots{k} = sim.robot(k);
end
hashes = {};
for attempt = 1:2
  sim.reset(7);
  for k = 1:40
    for j = 1:5
      r = robots{j};
      t = r.get_target("red");
      d = r.get_distances();
      r.set_velocity(0.3 * min(1, min(d)), 1.5 * t.bearing + 0.4 * (min(d(1:5)) < 0.5));
    end
    sim.step('timeout', 60);
  end
  assert(sim.steps == 40);
  hashes{attempt} = sim.hash();
end
assert(strcmp(hashes{1}, hashes{2}));
disp('passed')

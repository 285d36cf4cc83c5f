% SPDX-License-Identifier: MIT
function drive_steps(sim, r, n)
%DRIVE_STEPS n steps with a command in each.
  for k = 1:n
    r.set_velocity(0.1, 0);
    sim.step('timeout', 60);
  end
end

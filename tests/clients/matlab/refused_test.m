% SPDX-License-Identifier: MIT
% needs: fake --robots 5 --mode lockstep
% One refused robot of five never hangs the loop.
sim = coopdyn.connect();
robots = cell(1, 5);
for k = 1:5
  robots{k} = sim.robot(k);
end
for refused = {'robot3', 'robot1', '', 'robot5', ''}
  sim.call('/simulation', 'load_scenario', [], [], ['!refuse=' refused{1}]);
  for k = 1:5
    robots{k}.set_velocity(0.1 * k, 0);
  end
  if isempty(refused{1})
    sim.step('timeout', 60);
  else
    expect_error('coopdyn:out_of_range', @() sim.step('timeout', 60), refused{1});
  end
end
for k = 1:5
  p = robots{k}.get_pose();
  assert(abs(p.forward - 0.1 * k) < 1e-12);
end
disp('passed')

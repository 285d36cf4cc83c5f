% SPDX-License-Identifier: MIT
% needs: daemon classroom --mode realtime
% A program that is killed stops its robot in real time.
loop = ['addpath(''' fullfile(getenv('COOPDYN_ROOT'), 'clients', 'matlab') '''); sim = coopdyn.connect(); ' ...
        'r = sim.robot(1); while true, r.set_velocity(0.2, 0); sim.step(); end'];
program = system(['exec octave --no-gui --norc --eval "' loop '"'], false, 'async');
sim = coopdyn.connect('watch', true);
r = sim.robot(1);
for k = 1:6000
  w = r.get_wheels();
  if w.left_speed > 1
    break
  end
  sim.step();
end
assert(w.left_speed > 1);
kill(program, 9);
for k = 1:6000
  w = r.get_wheels();
  if abs(w.left_speed) < 1e-3
    break
  end
  sim.step();
end
assert(abs(w.left_speed) < 1e-3);
disp('passed')

% SPDX-License-Identifier: MIT
function speed = play_speed(speed)
%PLAY_SPEED How fast a recording is played; anything else is an error.
  speed = coopdyn.internal.number(speed, 'the speed');
  if speed < -4 || speed > 64 || speed == 0
    coopdyn.internal.fail(4, sprintf(['a recording is played at -4 to 64 times its speed (negative: backwards), not %g: write ' ...
      'sim.play(2), or sim.pause() to hold it'], speed));
  end
end

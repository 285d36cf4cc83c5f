% SPDX-License-Identifier: MIT
function end_process(process)
%END_PROCESS Ends a daemon that was launched: in order, after 10 s by force.
  signal = 'TERM';
  began = tic();
  while coopdyn.internal.is_running(process)
    if ~isempty(signal)
      system(sprintf('kill -%s %d 2>/dev/null', signal, process));
      signal = '';
    elseif toc(began) > 10
      signal = 'KILL';
    end
    pause(0.01);
  end
end

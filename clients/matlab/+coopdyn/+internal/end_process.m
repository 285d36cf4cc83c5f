% SPDX-License-Identifier: MIT
function end_process(process)
%END_PROCESS Shuts a launched daemon down; kills it after 10 s.
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

% SPDX-License-Identifier: MIT
classdef Wait < handle
%WAIT How long something may take: an error, "what within 5 s", after `limit` seconds. While it lasts it says once what the
%   world waits for; with held_up only if its steps do not go on.
  properties
    patient = false  % the next poll may wait a little, which sees a peer that is gone
    now_s = 0
  end
  properties (Access = private)
    address
    limit
    what
    held_up
    started
    notice_s = 2
    checked_s = 0
  end
  methods
    function w = Wait(address, limit, what, held_up)
      w.address = address;
      w.limit = limit;
      w.what = what;
      w.held_up = nargin > 3 && held_up;
      w.started = tic;
    end

    function rest(w)
    % A millisecond; raises what is over, says what is due.
      w.now_s = toc(w.started);
      if w.now_s > w.limit
        coopdyn.internal.fail(11, sprintf('%s within %g s; %s', w.what, w.limit, coopdyn.internal.whom(w.address)));
      end
      if w.now_s > w.notice_s
        text = coopdyn.internal.whom(w.address, w.held_up);
        w.notice_s = w.now_s + 2;
        if ~isempty(text)
          w.notice_s = Inf;
          fprintf(2, 'coopdyn: %s\n', text);
        end
      end
      w.patient = w.now_s - w.checked_s > 0.5;
      if w.patient
        w.checked_s = w.now_s;
      end
      pause(0.001);
    end
  end
end

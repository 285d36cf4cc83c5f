% SPDX-License-Identifier: MIT
classdef Wait < handle
%WAIT A wait with a timeout: an error, "what within 5 s", after `limit` seconds. A long wait reports once what the world
%   waits for; with held_up, only if no steps run. With in_step, raises coopdyn:reset if the world was reset or loaded
%   meanwhile.
  properties
    patient = false  % the next poll may wait a little, which detects a closed peer
    now_s = 0
  end
  properties (Access = private)
    session
    limit
    what
    held_up
    in_step
    started
    notice_s = 2
    checked_s = 0
  end
  methods
    function w = Wait(session, limit, what, held_up, in_step)
      w.session = session;
      w.limit = limit;
      w.what = what;
      w.held_up = nargin > 3 && held_up;
      w.in_step = nargin > 4 && in_step && ~session.watch;
      w.started = tic;
    end

    function rest(w)
    % Sleeps 1 ms; raises the timeout, or prints the notice, when due.
      w.now_s = toc(w.started);
      if w.now_s > w.limit
        coopdyn.internal.fail(11, sprintf('%s within %g s; %s', w.what, w.limit, whom(w.session, false, w.in_step)));
      end
      if w.now_s > w.notice_s
        text = whom(w.session, w.held_up, w.in_step);
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

function text = whom(session, held_up, in_step)
% One line that says what the world waits for; with held_up, empty if steps still run: lockstep waits for its robots
%   before every step, and less than 0.5 s is normal.
  try
    status = coopdyn.internal.fresh_status(session.address);
  catch cause
    text = ['no answer from the daemon (' cause.message ')'];
    return
  end
  if in_step && session.is_new(status)
    coopdyn.internal.raise('coopdyn:reset', 'reset');  % recover completes the text
  end
  if isfield(status, 'playback') && ~isempty(status.playback)
    p = status.playback;
    if p.step == p.end_step && ~p.playing && ~p.growing
      text = 'the recording has ended; sim.run() plays it again';
      return
    end
  end
  if strcmp(status.state, 'paused')
    text = 'the simulation is paused; continue with sim.run() or on the page';
    return
  elseif strcmp(status.state, 'ended')
    text = 'the run has ended; sim.reset() starts again';
    return
  end
  text = '';
  awaiting = status.awaiting;
  if held_up && (isempty(awaiting) || max([awaiting.seconds 0]) < 0.5)
    return
  end
  if isempty(awaiting)
    text = ['waiting for the next step, ' status.state];
    return
  end
  named = min(numel(awaiting), 4);
  for k = 1:named
    a = awaiting(k);
    text = sprintf('%s%s (%s), %.1f s, ', text, a.robot, a.why, a.seconds);
  end
  text = ['waiting for ' text(1:end - 2)];
  more = numel(awaiting) - named;
  if isfield(status, 'awaiting_count')
    more = status.awaiting_count - named;
  end
  if more > 0
    text = sprintf('%s and %d more', text, more);
  end
  if isfield(awaiting, 'cure')
    cures = {awaiting.cure};
    cures = cures(~cellfun('isempty', cures));
    if ~isempty(cures)  % how to continue without one of them
      text = [text ': ' cures{1}];
    end
  end
end

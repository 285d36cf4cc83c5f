% SPDX-License-Identifier: MIT
function ok = doctor(server, varargin)
%DOCTOR Checks the connection from the server's name to a round trip; prints ok, or cause and cure, per line.
%   coopdyn.doctor()   coopdyn.doctor('labserver:10100')   coopdyn.doctor('labserver', 'token', 'T')
%   coopdyn.doctor('labserver', 'seat', 'ana', 'pin', '7305')
  if nargin < 1
    server = '';
  end
  options = coopdyn.internal.options(varargin, struct('token', '', 'seat', [], 'pin', []));
  ok = false;
  try
    a = coopdyn.internal.address(server, '', options.token, 3, options.seat, options.pin);
    say(['server: ' a.text ' (' environment() ')']);
    socket = coopdyn.internal.dial(a);
    clear socket
    say(sprintf('port: %d is open', a.port));
    modules = coopdyn.internal.ask_names(a);
    if ~isempty(a.seat)
      say(['seat: ' a.seat ' is yours, by its PIN']);
    end
    ports = [modules.port 0];
    say(sprintf('names: %d modules on ports up to %d; this client needs %d only', numel(modules), max(ports), a.port));
    sim = coopdyn.connect(server, 'token', options.token, 'seat', options.seat, 'pin', options.pin);
    s = sim.status();
    say(sprintf('versions: daemon %s, protocol %d', char(s.version), s.protocol));
    took = zeros(1, 50);
    for k = 1:50
      t = tic;
      sim.call('/simulation', 3);
      took(k) = toc(t);
    end
    say(sprintf('round trip: %.0f us (median of 50), longest %.0f us', median(took) * 1e6, max(took) * 1e6));
    say(sprintf('time: %s, %s, step %d, dt %g s', s.mode, s.state, s.step, s.step_s));
    for k = 1:numel(s.robots)
      owner = s.robots(k).owner;
      if isempty(owner)
        say(['robot: ' s.robots(k).name ', free']);
      else
        say(['robot: ' s.robots(k).name ', driven by ' char(owner)]);
      end
    end
    for w = sim.waiting()
      say(sprintf('waiting for %s (%s), %.1f s', w.robot, w.why, w.seconds));
    end
    sim.close();
    ok = true;
  catch cause
    fprintf('FAIL  %s\n', cause.message);
  end
  if nargout == 0
    clear ok
  end
end

function say(text)
  fprintf('ok    %s\n', text);
end

function text = environment()
  if coopdyn.internal.is_octave()
    text = ['Octave ' version()];
  else
    text = ['MATLAB ' version()];
  end
end

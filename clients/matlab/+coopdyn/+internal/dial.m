% SPDX-License-Identifier: MIT
function socket = dial(a)
%DIAL A tcpclient connected to the daemon's port; errors say cause and cure.
  silent = sprintf(['no answer from %s within %g s: the machine is off, the address is wrong, or a firewall drops ' ...
                    'the packets; try ping, or a tunnel: ssh -L 10000:127.0.0.1:10000 HOST'], a.text, a.timeout);
  try
    if coopdyn.internal.is_octave()
      load_package();
      local = strncmp(a.host, '127.', 4) || any(strcmp(a.host, {'localhost', '::1'}));
      if ~local && strcmp(coopdyn.internal.probe(a.host, a.port, a.timeout), 'silent')
        coopdyn.internal.fail(11, silent);
      end
      socket = tcpclient(a.host, a.port, 'Timeout', 0.02);
    else
      try
        socket = tcpclient(a.host, a.port, 'ConnectTimeout', a.timeout, 'Timeout', 1, 'EnableTransferDelay', false);
      catch cause
        if isempty(strfind(lower(cause.message), 'transferdelay'))
          rethrow(cause);
        end
        socket = tcpclient(a.host, a.port, 'ConnectTimeout', a.timeout, 'Timeout', 1);
      end
    end
  catch cause
    if strncmp(cause.identifier, 'coopdyn:', 8)
      rethrow(cause);
    end
    if ~isempty(regexpi(cause.message, 'timed? ?out', 'once'))
      coopdyn.internal.fail(11, silent);
    end
    if ~isempty(regexpi(cause.message, 'look(ing)? ?up|resolv|unknown host|no such host', 'once'))
      coopdyn.internal.fail(-1, ['no machine is called ''' a.host '''; check the name, or write its address']);
    end
    coopdyn.internal.fail(-1, [ ...
      'nothing listens at ' a.text ': start the daemon there (coopdyn serve; for other machines add --host 0.0.0.0), ' ...
      'or name the server: coopdyn.connect(''HOST:PORT'') or COOPDYN_SERVER (' strtrim(cause.message) ')']);
  end
end

function load_package()
  if exist('tcpclient', 'file') == 0
    try
      pkg('load', 'instrument-control');
    catch
      coopdyn.internal.fail(5, ['Octave needs its package instrument-control: apt install octave-instrument-control, ' ...
                                'or pkg install -forge instrument-control']);
    end
  end
end

% SPDX-License-Identifier: MIT
function modules = ask_names(a)
%ASK_NAMES Every name of the daemon: a 1 x n struct with name, host, port.
  socket = coopdyn.internal.dial(a);
  write(socket, uint8(['NAME_SERVER list' char(10)]));
  said = '';
  started = tic;
  while isempty(strfind(said, '*** end of message'))
    n = socket.NumBytesAvailable;
    if n > 0
      said = [said char(read(socket, n))]; %#ok<AGROW>
      if any(said == char(10)) && isempty(regexp(said, '^(registration |\*\*\*)', 'once'))
        coopdyn.internal.not_a_daemon(a, strtrim(strtok(said, char(10))));
      end
    elseif toc(started) > a.timeout
      coopdyn.internal.fail(11, [a.text ' does not answer: the daemon is stopped or busy, or something else listens there']);
    else
      pause(0.001);
    end
  end
  found = regexp(said, 'registration name (/\S+) ip (\S+) port (\d+)', 'tokens');
  if isempty(found)
    coopdyn.internal.not_a_daemon(a, 'a list without modules');
  end
  modules = struct('name', {}, 'host', {}, 'port', {});
  for k = 1:numel(found)
    modules(1, k) = struct('name', found{k}{1}, 'host', found{k}{2}, 'port', str2double(found{k}{3}));
  end
end

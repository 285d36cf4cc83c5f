% SPDX-License-Identifier: MIT
function modules = ask_names(a)
%ASK_NAMES All names registered at the daemon: a 1 x n struct with name, host, port.
  socket = coopdyn.internal.dial(a);
  known = '^(registration |\*\*\*)';
  said = coopdyn.internal.begin(a, socket, 'NAME_SERVER list', '\n');
  if isempty(regexp(said, known, 'once'))
    coopdyn.internal.refuse(a, strtrim(strtok(said, char(10))));
  end
  said = coopdyn.internal.hear(a, socket, said, '\*\*\* end of message', a.timeout);
  found = regexp(said, 'registration name (/\S+) ip (\S+) port (\d+)', 'tokens');
  if isempty(found)
    coopdyn.internal.not_a_daemon(a, 'a list without modules');
  end
  modules = struct('name', {}, 'host', {}, 'port', {});
  for k = 1:numel(found)
    modules(1, k) = struct('name', found{k}{1}, 'host', found{k}{2}, 'port', str2double(found{k}{3}));
  end
end

% SPDX-License-Identifier: MIT
function d = describe(session, name)
%DESCRIBE A module's description of its commands, queried on a separate connection.
  session.require_open();
  c = coopdyn.internal.Connection(session.address, ['/' regexprep(coopdyn.internal.word(name, 'a module, as ''/robot1/motors'','), '^/|/$', '')]);
  reply = session.ask(c, 1, [], '');
  c.close();
  d = jsondecode(reply.text);
end

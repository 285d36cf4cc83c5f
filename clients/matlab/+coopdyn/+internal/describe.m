% SPDX-License-Identifier: MIT
function d = describe(session, name)
%DESCRIBE What a module says about its commands, asked on a connection of its own.
  session.require_open();
  c = coopdyn.internal.Connection(session.address, ['/' regexprep(coopdyn.internal.word(name, 'a module, as ''/robot1/motors'','), '^/|/$', '')]);
  reply = session.ask(c, 1, [], '');
  c.close();
  d = jsondecode(reply.text);
end

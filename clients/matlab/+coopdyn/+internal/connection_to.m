% SPDX-License-Identifier: MIT
function c = connection_to(session, module)
%CONNECTION_TO The session's own connection to a module of a robot that it does not drive, or of the whole; made at its
%   first use.
  for k = 1:numel(session.others)
    c = session.others{k};
    if strcmp(c.module, module)
      return
    end
  end
  c = coopdyn.internal.Connection(session.address, module, ~session.watch);
  session.others{end + 1} = c;
end

% SPDX-License-Identifier: MIT
function reply = tell(session, module, command, params, data, text, limit)
%TELL A request to a module of the whole simulation other than /simulation.
  if nargin < 7, limit = 10; end
  if nargin < 6, text = ''; end
  if nargin < 5, data = []; end
  if nargin < 4, params = []; end
  session.require_open();
  c = coopdyn.internal.connection_to(session, module);
  if ~c.alive()
    c.open();
  end
  reply = c.request(command, params, data, text, limit);
  session.forget_readings();
  session.note(reply);
end

% SPDX-License-Identifier: MIT
function status = fresh_status(address)
%FRESH_STATUS The status, asked on a connection of its own: others may be waiting.
  c = coopdyn.internal.Connection(address, '/simulation');
  c.open();
  reply = c.request(100, [], [], '', address.timeout);
  c.close();
  status = jsondecode(reply.text);
end

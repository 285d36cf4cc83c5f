% SPDX-License-Identifier: MIT
function status = fresh_status(address)
%FRESH_STATUS Queries the status on a separate connection, because the others may have replies pending.
  c = coopdyn.internal.Connection(address, '/simulation');
  c.open();
  reply = c.request(100, [], [], '', address.timeout);
  c.close();
  status = jsondecode(reply.text);
end

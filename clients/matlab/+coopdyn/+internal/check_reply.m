% SPDX-License-Identifier: MIT
function check_reply(reply, who)
%CHECK_REPLY Raises an error reply.
  if reply.error ~= 0
    coopdyn.internal.fail(reply.error, [who reply.text]);
  end
end

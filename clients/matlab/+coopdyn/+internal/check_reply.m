% SPDX-License-Identifier: MIT
function check_reply(reply, who)
%CHECK_REPLY Raises an error reply. If a reset or load ended the wait, raises coopdyn:reset with a one-word text, which
%   Session.new_world turns into a message.
  if reply.error == 5 && any(strcmp(reply.text, {'reset', 'load'}))
    coopdyn.internal.raise('coopdyn:reset', reply.text);
  end
  if reply.error ~= 0
    coopdyn.internal.fail(reply.error, [who reply.text]);
  end
end

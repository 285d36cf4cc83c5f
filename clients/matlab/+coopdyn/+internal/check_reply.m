% SPDX-License-Identifier: MIT
function check_reply(reply, who)
%CHECK_REPLY Raises an error reply. If a reset or load has ended the wait: coopdyn:reset with one word, which
%   Session.new_world makes a text.
  if reply.error == 5 && any(strcmp(reply.text, {'reset', 'load'}))
    coopdyn.internal.raise('coopdyn:reset', reply.text);
  end
  if reply.error ~= 0
    coopdyn.internal.fail(reply.error, [who reply.text]);
  end
end

% SPDX-License-Identifier: MIT
function not_a_daemon(a, said)
%NOT_A_DAEMON Raises the error for another program that listens at the address and sent this text.
  said = said(1:min(end, 60));
  coopdyn.internal.fail(-1, ['what listens at ' a.text ' is not a coopdyn daemon (it said "' said '"); name the server''s ' ...
                             'port, which coopdyn serve prints: HOST:PORT']);
end

% SPDX-License-Identifier: MIT
function refuse(a, said)
%REFUSE Raises the error that an unexpected answer line stands for.
  % error 10 no such name /robot9/motors; did you mean /robot1/motors
  found = regexp(said, '^error (\d+) (.+)$', 'tokens', 'once');
  if ~isempty(found)
    coopdyn.internal.fail(str2double(found{1}), found{2});
  end
  if isempty(said) && ~isempty(a.seat)
    coopdyn.internal.fail(-1, [a.text ' closed the connection of the seat ' a.seat ' without an answer; ask your teacher ' ...
                               'whether the class runs there, and this seat']);
  end
  coopdyn.internal.not_a_daemon(a, said);
end

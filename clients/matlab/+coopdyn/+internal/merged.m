% SPDX-License-Identifier: MIT
function command = merged(kept, command, whose)
%MERGED What one step is to do that was told `kept` before, `command` now: {number, data, joints}. What both say of a joint,
%  the last wins.
  if isempty(kept) || all(ismember(kept{3}, command{3}))
    return
  end
  if kept{1} ~= command{1}
    coopdyn.internal.fail(5, ['two commands for different joints cannot go with one step of ' whose ...
      ': write sim.step() between them, or command the joints alike']);
  end
  left = ~ismember(kept{3}, command{3});
  command{3} = [kept{3}(left) command{3}];
  if ~isempty(command{2})
    command{2} = [kept{2}(left) command{2}];
  end
end

% SPDX-License-Identifier: MIT
function command = merged(kept, command, whose)
%MERGED Merges `command` with `kept`, an earlier one for the same step: {number, data, joints}. Where both name a joint,
%  `command` wins.
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

% SPDX-License-Identifier: MIT
function t = choose_target(targets, x)
%CHOOSE_TARGET The target with this id, or the nearest of this colour; error if there is none.
  if isnumeric(x)
    fits = find([targets.id] == x);
  else
    fits = find(strcmp({targets.colour}, char(x)));
  end
  if isempty(fits)
    there = strjoin({targets.colour}, ', ');
    if isempty(there)
      there = 'none';
    end
    coopdyn.internal.fail(10, ['there is no target ' num2str(x) '; there are: ' there]);
  end
  [~, nearest] = min([targets(fits).distance]);
  t = targets(fits(nearest));
end

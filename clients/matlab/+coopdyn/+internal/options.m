% SPDX-License-Identifier: MIT
function chosen = options(pairs, chosen)
%OPTIONS Applies name-value pairs to their defaults; unknown names are errors.
  known = fieldnames(chosen);
  if mod(numel(pairs), 2) ~= 0
    coopdyn.internal.fail(2, ['options come in pairs of name and value; names are: ' strjoin(known', ', ')]);
  end
  for k = 1:2:numel(pairs)
    name = pairs{k};
    if ~coopdyn.internal.is_text(name) || ~any(strcmpi(name, known))
      coopdyn.internal.fail(2, ['there is no option ' coopdyn.internal.show(name) '; there are: ' strjoin(known', ', ')]);
    end
    chosen.(lower(char(name))) = pairs{k + 1};
  end
end

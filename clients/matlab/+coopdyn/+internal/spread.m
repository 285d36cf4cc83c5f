% SPDX-License-Identifier: MIT
function values = spread(values, n, one)
%SPREAD One value for each of n joints or other parts; a single value is repeated.
  if ~isnumeric(values) || ~isreal(values) || ~any(numel(values) == [1 n])
    coopdyn.internal.fail(3, sprintf('write a value for each of the %d %ss, or one for all, not %s', n, one, ...
                                     coopdyn.internal.show(values)));
  end
  values = reshape(double(values), 1, []);
  if numel(values) == 1
    values = repmat(values, 1, n);
  end
end

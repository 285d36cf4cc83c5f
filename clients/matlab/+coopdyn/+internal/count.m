% SPDX-License-Identifier: MIT
function n = count(n, what)
%COUNT A whole number of at least 1; anything else is an error.
  if ~isnumeric(n) || numel(n) ~= 1 || n ~= round(n)
    coopdyn.internal.fail(2, [what ' must be a whole number']);
  end
  if n < 1 || n > 2147483647
    coopdyn.internal.fail(4, [what ' must be at least 1']);
  end
  n = double(n);
end

% SPDX-License-Identifier: MIT
function n = count(n, what)
%COUNT An integer of at least 1; anything else is an error.
  if ~isnumeric(n) || numel(n) ~= 1 || n ~= round(n)
    coopdyn.internal.fail(2, [what ' must be a whole number, not ' coopdyn.internal.show(n)]);
  end
  if n < 1
    coopdyn.internal.fail(4, sprintf('%s must be at least 1, not %d', what, n));
  elseif n > 2147483647
    coopdyn.internal.fail(4, sprintf('%s must be a whole number of 32 bits, not %d', what, n));
  end
  n = double(n);
end

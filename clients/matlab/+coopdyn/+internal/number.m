% SPDX-License-Identifier: MIT
function x = number(x, what)
%NUMBER One finite double; anything else is an error.
  if ~(isnumeric(x) || islogical(x)) || numel(x) ~= 1 || ~isreal(x)
    coopdyn.internal.fail(3, [what ' must be one number, not ' coopdyn.internal.show(x)]);
  end
  x = double(x);
  if ~isfinite(x)
    coopdyn.internal.fail(4, [what ' must be finite, not ' num2str(x)]);
  end
end

% SPDX-License-Identifier: MIT
function yes = is_text(x)
%IS_TEXT One text: a row of characters, or a string of MATLAB.
  yes = ischar(x) && size(x, 1) <= 1 || isa(x, 'string') && isscalar(x);
end

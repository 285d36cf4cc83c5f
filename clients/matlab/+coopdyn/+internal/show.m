% SPDX-License-Identifier: MIT
function text = show(x)
%SHOW A value as printed in errors: 'abc', 2.5, [1 2], a 1 x 2 cell.
  if coopdyn.internal.is_text(x)
    text = ['''' char(x) ''''];
  elseif (isnumeric(x) || islogical(x)) && ismatrix(x) && any(numel(x) == 1:8)
    text = mat2str(x);
  else
    text = sprintf('a %s %s', strjoin(arrayfun(@num2str, size(x), 'UniformOutput', false), ' x '), class(x));
  end
end

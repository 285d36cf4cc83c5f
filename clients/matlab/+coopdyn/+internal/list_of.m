% SPDX-License-Identifier: MIT
function text = list_of(names)
%LIST_OF Lists names for an error; of many, the first twenty and their total number.
  text = 'none';
  if ~isempty(names)
    text = strjoin(reshape(names(1:min(end, 20)), 1, []), ', ');
  end
  if numel(names) > 20
    text = sprintf('%s, ... (%d)', text, numel(names));
  end
end

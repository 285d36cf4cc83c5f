% SPDX-License-Identifier: MIT
function text = list_of(names)
%LIST_OF Names for an error; if there are many, the first twenty and their number.
  text = 'none';
  if ~isempty(names)
    text = strjoin(reshape(names(1:min(end, 20)), 1, []), ', ');
  end
  if numel(names) > 20
    text = sprintf('%s, ... (%d)', text, numel(names));
  end
end

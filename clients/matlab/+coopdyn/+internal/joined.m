% SPDX-License-Identifier: MIT
function text = joined(names, example)
%JOINED Names of robots, one text or a cell array of texts, with spaces between them; anything else is an error.
  if isa(names, 'string')
    names = cellstr(names);
  elseif isempty(names)
    names = {};
  end
  if ~iscell(names)
    names = {names};
  end
  for k = 1:numel(names)
    if ~coopdyn.internal.is_text(names{k})
      coopdyn.internal.fail(3, ['robots are named, not ' coopdyn.internal.show(names{k}) '; write e.g. ' example]);
    end
  end
  text = strjoin(cellfun(@char, reshape(names, 1, []), 'UniformOutput', false), ' ');
end

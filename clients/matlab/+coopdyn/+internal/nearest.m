% SPDX-License-Identifier: MIT
function text = nearest(name, known)
%NEAREST What the name is but for its capitals, as part of an error.
  text = '';
  found = find(strcmpi(known, name), 1);
  if ~isempty(found)
    text = ['did you mean ' known{found} '? '];
  end
end

% SPDX-License-Identifier: MIT
function text = nearest(name, known)
%NEAREST The known name that differs in capitals only, as part of an error.
  text = '';
  found = find(strcmpi(known, name), 1);
  if ~isempty(found)
    text = ['did you mean ' known{found} '? '];
  end
end

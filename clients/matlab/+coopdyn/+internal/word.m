% SPDX-License-Identifier: MIT
function text = word(text, what)
%WORD One word that the daemon takes as a name; anything else is an error.
  if isnumeric(text) || iscell(text)
    coopdyn.internal.fail(3, [what ' is one word']);
  end
  text = strtrim(char(text));
  if isempty(regexp(text, '^\S+$', 'once'))
    coopdyn.internal.fail(3, [what ' is one word, not ''' text '''']);
  end
end

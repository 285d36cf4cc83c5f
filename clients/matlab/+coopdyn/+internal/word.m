% SPDX-License-Identifier: MIT
function text = word(text, what)
%WORD Returns the only word of a text; anything else is an error.
  if ~coopdyn.internal.is_text(text) || isempty(regexp(strtrim(char(text)), '^\S+$', 'once'))
    coopdyn.internal.fail(3, [what ' is one word, not ' coopdyn.internal.show(text)]);
  end
  text = strtrim(char(text));
end

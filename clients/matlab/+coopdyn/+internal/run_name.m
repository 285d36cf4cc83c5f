% SPDX-License-Identifier: MIT
function text = run_name(text)
%RUN_NAME The name of a recording, a file name that may contain blanks; anything else is an error.
  if ~coopdyn.internal.is_text(text) || isempty(strtrim(char(text)))
    coopdyn.internal.fail(3, ['the name of a recording is a text, not ' coopdyn.internal.show(text)]);
  end
  text = char(text);
end

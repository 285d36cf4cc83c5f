% SPDX-License-Identifier: MIT
function word = first_word(text)
%FIRST_WORD Up to the first space.
  word = strtok(text, ' ');
end

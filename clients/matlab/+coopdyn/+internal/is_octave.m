% SPDX-License-Identifier: MIT
function yes = is_octave()
%IS_OCTAVE True in GNU Octave.
  persistent octave
  if isempty(octave)
    octave = exist('OCTAVE_VERSION', 'builtin') ~= 0;
  end
  yes = octave;
end

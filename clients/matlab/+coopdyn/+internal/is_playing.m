% SPDX-License-Identifier: MIT
function yes = is_playing(cause)
%IS_PLAYING True if the error says that a recording is played, in which no robot can be driven.
  yes = strcmp(cause.identifier, 'coopdyn:not_possible') && strncmp(cause.message, 'playing a recording', 19);
end

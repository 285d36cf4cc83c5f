% SPDX-License-Identifier: MIT
function name = error_name(code)
%ERROR_NAME The word of an error code of the protocol; -1: no connection.
  names = {'unknown_command', 'wrong_params', 'wrong_data', 'out_of_range', 'not_possible', 'owned', 'malformed', ...
           'too_large', 'internal', 'no_such_name', 'timed_out', 'not_allowed'};
  if code == -1
    name = 'connection';
  elseif code >= 1 && code <= numel(names)
    name = names{code};
  else
    name = 'error';
  end
end

% SPDX-License-Identifier: MIT
function fail(code, text)
%FAIL Raises the error with the identifier of this code of the protocol, e.g. coopdyn:owned; -1: no connection.
  names = {'unknown_command', 'wrong_params', 'wrong_data', 'out_of_range', 'not_possible', 'owned', 'malformed', ...
           'too_large', 'internal', 'no_such_name', 'timed_out', 'not_allowed'};
  name = 'error';
  if code == -1
    name = 'connection';
  elseif code >= 1 && code <= numel(names)
    name = names{code};
  end
  coopdyn.internal.raise(['coopdyn:' name], text);
end

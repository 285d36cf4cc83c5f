% SPDX-License-Identifier: MIT
function fail(code, text)
%FAIL Raises the error with the identifier of this code, e.g. coopdyn:owned.
  error(['coopdyn:' coopdyn.internal.error_name(code)], '%s', text);
end

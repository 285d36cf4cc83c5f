% SPDX-License-Identifier: MIT
function need(given, wanted, example)
%NEED Raises an error that says what to write if a call has too few arguments; the object counts as one.
  if given < wanted
    coopdyn.internal.fail(2, ['an argument is missing: write ' example]);
  end
end

% SPDX-License-Identifier: MIT
function raise(identifier, text)
%RAISE Raises an error. Its text says all: Octave, which prints every function on the way, prints those of the program only.
  if ~coopdyn.internal.is_octave()
    error(identifier, '%s', text);
  end
  stack = dbstack();
  ours = fileparts(fileparts(mfilename('fullpath')));
  rethrow(struct('identifier', identifier, 'message', text, 'stack', stack(~strncmp({stack.file}, ours, numel(ours)))));
end

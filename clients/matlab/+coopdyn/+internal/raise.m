% SPDX-License-Identifier: MIT
function raise(identifier, text)
%RAISE Raises an error. Its text is sufficient: Octave prints every function on the stack, here only those of the program.
  if ~coopdyn.internal.is_octave()
    error(identifier, '%s', text);
  end
  stack = dbstack();
  ours = fileparts(fileparts(mfilename('fullpath')));
  rethrow(struct('identifier', identifier, 'message', text, 'stack', stack(~strncmp({stack.file}, ours, numel(ours)))));
end

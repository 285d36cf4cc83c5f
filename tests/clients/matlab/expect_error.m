% SPDX-License-Identifier: MIT
function expect_error(identifier, call, varargin)
%EXPECT_ERROR Asserts that the call fails with this identifier, that the text has each of the words, and shows no internals.
  try
    call();
  catch cause
    assert(strcmp(cause.identifier, identifier), ['got ' cause.identifier ': ' cause.message]);
    inside = ~cellfun('isempty', strfind({cause.stack.file}, '+coopdyn'));
    assert(~any(inside), ['its stack has ' strjoin({cause.stack(inside).name}, ', ')]);
    for k = 1:numel(varargin)
      assert(~isempty(strfind(cause.message, varargin{k})), ['"' varargin{k} '" is not in: ' cause.message]);
    end
    return
  end
  error('test:nothing', '%s', ['no error, expected ' identifier]);
end

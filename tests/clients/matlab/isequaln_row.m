% SPDX-License-Identifier: MIT
function yes = isequaln_row(a, b)
%ISEQUALN_ROW Equal rows of doubles, NaN equal to NaN, empty ones of any shape equal.
  yes = numel(a) == numel(b) && all((a(:) == b(:)) | (isnan(a(:)) & isnan(b(:))));
end

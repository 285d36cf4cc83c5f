% SPDX-License-Identifier: MIT
function bytes = encode(command, params, data, text)
%ENCODE The binary frame of a request, a row of uint8.
  if nargin < 4
    raw = zeros(1, 0, 'uint8');
  else
    raw = unicode2native(char(text), 'UTF-8');
    raw = reshape(uint8(raw), 1, []);
  end
  t = numel(raw);
  m = numel(params);
  n = numel(data);
  head = typecast(int32([20 + t + 4 * m + 8 * n, 0, command, t, m, n]), 'uint8');
  if m == 0 && n == 0
    bytes = [head raw];
    return
  end
  bytes = [head raw typecast(int32(reshape(params, 1, [])), 'uint8') typecast(double(reshape(data, 1, [])), 'uint8')];
end

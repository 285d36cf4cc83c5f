% SPDX-License-Identifier: MIT
function [message, used] = decode(bytes)
%DECODE The first message of a row of uint8 and its size in bytes; [] and 0 if it is incomplete.
  message = [];
  used = 0;
  if numel(bytes) < 24
    return
  end
  h = double(typecast(bytes(1:24), 'int32'));
  t = h(4);
  m = h(5);
  n = h(6);
  if any([t m n] < 0) || h(1) ~= 20 + t + 4 * m + 8 * n
    coopdyn.internal.fail(7, 'the bytes received are not a coopdyn message');
  end
  last = 4 + h(1);
  if numel(bytes) < last
    return
  end
  used = last;
  at = 24 + t;
  text = '';
  if t > 0
    text = native2unicode(bytes(25:at), 'UTF-8');
    text = reshape(text, 1, []);
  end
  params = zeros(1, 0);
  if m > 0
    params = typecast(bytes(at + 1:at + 4 * m), 'int32');
    if m <= 1024  % more are a picture's bytes
      params = double(params);
    end
  end
  data = zeros(1, 0);
  if n > 0
    data = typecast(bytes(at + 4 * m + 1:last), 'double');
  end
  message = struct('error', h(2), 'text', text, 'command', h(3), 'params', params, 'data', data);
end

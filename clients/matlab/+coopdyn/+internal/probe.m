% SPDX-License-Identifier: MIT
function answer = probe(host, port, timeout)
%PROBE Octave only: whether a connection can be made within `timeout` seconds: 'ok', 'refused', 'silent', 'unknown'.
%   Octave's tcpclient has no timeout for connecting and waits for minutes where packets are dropped, so bash tries
%   first. 'unknown': bash or timeout is missing.
  [code, ~] = system(sprintf('timeout %g bash -c ''exec 3<>/dev/tcp/%s/%d'' >/dev/null 2>&1', timeout, host, port));
  switch code
    case 0
      answer = 'ok';
    case 124
      answer = 'silent';
    case 1
      answer = 'refused';
    otherwise
      answer = 'unknown';
  end
end

% SPDX-License-Identifier: MIT
function said = hear(a, socket, said, pattern, limit)
%HEAR Reads until the received text matches a pattern, or the connection has ended. limit: seconds.
  started = tic;
  looked = 0;
  while isempty(regexp(said, pattern, 'once'))
    n = socket.NumBytesAvailable;
    if n > 0
      said = [said char(read(socket, n))]; %#ok<AGROW>
    elseif toc(started) > limit
      coopdyn.internal.fail(11, [a.text ' accepts connections but does not answer: the daemon is stopped ' ...
                                 'or busy, or something else listens there; try coopdyn status']);
    elseif coopdyn.internal.is_octave() && toc(started) - looked > 0.5
      looked = toc(started);
      try
        said = [said char(read(socket, 1))]; %#ok<AGROW>
      catch
        return  % the only way in which Octave detects the end
      end
    elseif toc(started) > 0.002
      pause(0.001);
    end
  end
end

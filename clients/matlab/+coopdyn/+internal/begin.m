% SPDX-License-Identifier: MIT
function said = begin(a, socket, line, pattern)
%BEGIN Sends a connection's first line, in a class after a line with seat and PIN. Returns the part of the answer that
%  matches the pattern.
  seat_start = 20;  % of a seat's daemon [s]: all start at once when a class begins
  said = '';
  limit = a.timeout;
  if isempty(a.seat)
    write(socket, uint8([line char(10)]));
  else
    write(socket, uint8(['SEAT ' a.seat ' ' a.pin ' ' language() char(10) line char(10)]));
    said = coopdyn.internal.hear(a, socket, '', '\n', limit);
    [first, said] = strtok([said char(10)], char(10));
    if strncmp(first, '***', 3)  % a name server's answer to an unknown word
      text = [a.text ' is not a class: leave seat and pin out'];
      if ~isempty(getenv('COOPDYN_SEAT'))
        text = [text ', and COOPDYN_SEAT, too'];
      end
      coopdyn.internal.fail(5, text);
    elseif ~strcmp(first, 'ok')
      coopdyn.internal.refuse(a, strtrim(first));
    end
    said = said(2:end - 1);
    limit = max(limit, seat_start);
  end
  said = coopdyn.internal.hear(a, socket, said, pattern, limit);
end

function word = language()
  word = 'matlab';
  if coopdyn.internal.is_octave()
    word = 'octave';
  end
end

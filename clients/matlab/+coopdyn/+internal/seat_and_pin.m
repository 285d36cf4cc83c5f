% SPDX-License-Identifier: MIT
function [seat, pin] = seat_and_pin(seat, pin)
%SEAT_AND_PIN A seat of a class and its PIN: as given, or if [] from COOPDYN_SEAT; both '': none.
  how = '; write coopdyn.connect(''labserver'', ''seat'', ''ana'', ''pin'', ''7305'') as on your sheet, or COOPDYN_SEAT=ana:7305';
  if is_none(seat) && is_none(pin)
    [seat, rest] = strtok([strtrim(getenv('COOPDYN_SEAT')) ' '], ': ');
    pin = strtrim(rest(2:end));
  end
  if isnumeric(pin) && isscalar(pin)
    coopdyn.internal.fail(3, sprintf(['a PIN is a text, since a number loses the zeros at its beginning: ' ...
                                      'write ''pin'', ''%04d'''], pin));
  end
  if isempty(seat) && isempty(pin)
    seat = '';
    pin = '';
    return
  end
  if isempty(seat) || isempty(pin)
    what = 'a PIN needs its seat';
    if ~isempty(seat)
      what = ['the seat ' coopdyn.internal.show(seat) ' needs its PIN'];
    end
    coopdyn.internal.fail(3, [what how]);
  end
  if ~fits(seat, '^[a-z0-9][a-z0-9_-]{0,31}$')
    coopdyn.internal.fail(3, ['the name of a seat has only a-z, 0-9, - and _, not ' coopdyn.internal.show(seat) how]);
  end
  if ~fits(pin, '^[A-Za-z0-9]{4,16}$')
    coopdyn.internal.fail(3, ['a PIN has 4 to 16 letters or digits, not ' coopdyn.internal.show(pin) how]);
  end
  seat = char(seat);
  pin = char(pin);
end

function yes = is_none(value)
  yes = isnumeric(value) && isempty(value);
end

function yes = fits(value, pattern)
  yes = coopdyn.internal.is_text(value) && ~isempty(regexp(char(value), pattern, 'once'));
end

% SPDX-License-Identifier: MIT
function a = address(server, name, token, timeout, seat, pin)
%ADDRESS The daemon's address and the client's identity: host, port, text, name, hello, reader_hello, timeout, seat, pin, why_lost.
%   seat and pin: of a class; both []: COOPDYN_SEAT; seat '': none.
  if nargin < 6
    seat = [];
    pin = [];
  end
  forms = '; write HOST, HOST:PORT, or a port of this machine, e.g. ''labserver:10100''';
  if isnumeric(server) && isempty(server)
    server = '';
  elseif isnumeric(server) && isscalar(server) && server == round(server)
    server = sprintf('%d', server);
  elseif ~coopdyn.internal.is_text(server)
    coopdyn.internal.fail(4, ['cannot read the server ' coopdyn.internal.show(server) forms]);
  end
  given = strtrim(char(server));
  if isempty(given)
    given = getenv('COOPDYN_SERVER');
  end
  if isempty(given)
    given = '127.0.0.1';
  end
  if ~isempty(strfind(given, '://'))
    coopdyn.internal.fail(4, [given ' is the address of the page; a program connects to the name server, whose HOST:PORT ' ...
      '`coopdyn serve` prints: write e.g. coopdyn.connect(''127.0.0.1:10000'')']);
  end
  if strncmp(given, 'unix:/', 6)
    coopdyn.internal.fail(4, ['MATLAB and Octave connect by TCP only, not to ' given ': write HOST:PORT, or use the client in ' ...
      'Python or C++']);
  end
  host = given;
  port = 10000;
  if all(given >= '0' & given <= '9')  % a port of this machine
    host = '127.0.0.1';
    port = str2double(given);
  elseif given(1) == '['  % [::1]:10000
    close = find(given == ']', 1);
    host = given(2:close - 1);
    rest = given(close + 1:end);
    if ~isempty(rest)
      port = str2double(rest(2:end));
    end
  elseif sum(given == ':') == 1
    colon = find(given == ':');
    host = given(1:colon - 1);
    port = str2double(given(colon + 1:end));
  end
  if isempty(regexp(host, '^[A-Za-z0-9:_][A-Za-z0-9.:_-]*$', 'once')) || ~(port > 0 && port < 65536 && port == round(port))
    coopdyn.internal.fail(4, ['cannot read the server ''' given '''' forms]);
  end
  if isempty(name)
    name = default_name();
  elseif ~coopdyn.internal.is_text(name) || any(isspace(name))
    coopdyn.internal.fail(3, ['a client name has no spaces, not ' coopdyn.internal.show(name) '; write e.g. ''ana''']);
  end
  name = char(name);
  a.host = host;
  a.port = port;
  a.text = sprintf('%s:%d', host, port);
  a.name = name;
  a.hello = strtrim([name ' ' char(token)]);
  a.reader_hello = strtrim([name ':reader ' char(token)]);
  a.timeout = coopdyn.internal.number(timeout, 'timeout [s]');
  [a.seat, a.pin] = coopdyn.internal.seat_and_pin(seat, pin);
  a.why_lost = 'is the daemon still running?';
  if ~isempty(a.seat)
    a.why_lost = ['the class restarts the seat ' a.seat ' where it was: run your program again'];
  end
end

function name = default_name()
  user = getenv('USER');
  if isempty(user) && coopdyn.internal.is_octave() && isunix()
    account = getpwuid(getuid());
    if isstruct(account)
      user = account.name;
    end
  end
  if isempty(user)
    user = getenv('USERNAME');
  end
  if isempty(user)
    user = 'user';
  end
  if coopdyn.internal.is_octave()
    host = gethostname();
    pid = getpid();
  else
    host = getenv('COMPUTERNAME');
    if isempty(host)
      [~, host] = system('hostname');
    end
    pid = feature('getpid');
  end
  name = sprintf('%s@%s:%d', user, strtrim(host), pid);
  name = name(~isspace(name));
end

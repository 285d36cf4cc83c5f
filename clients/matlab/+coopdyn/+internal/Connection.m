% SPDX-License-Identifier: MIT
classdef Connection < handle
%CONNECTION One connection to one module, through the daemon's one port.
%   idle: open, and no reply is pending. Other connections accept no requests (Ctrl-C leaves one in this state).
%   Replies are read at once with the length of the last reply to the same command; a shorter or longer reply is then
%   completed.
  properties
    address
    module
    socket = []
    idle = false
    pushes = {}
    notice = ''
  end
  properties (Access = private)
    hello
    buffer = zeros(1, 0, 'uint8')
    octave = false
    fast = []    % the socket in Octave, whose read waits for the requested bytes; at most 0.02 s
    sizes = 24 * ones(1, 1024)
    asked = 1
  end
  methods
    function c = Connection(address, module, drives, number)
    % drives: sends the plain name; a client of the same name takes over an actuator module, which a reader must not do.
    % number: of a team; distinguishes the teams of one program.
      c.hello = address.reader_hello;
      if nargin > 2 && drives
        c.hello = address.hello;
      end
      if nargin > 3 && number > 1
        c.hello = sprintf('%s:%d%s', address.name, number, address.hello(numel(address.name) + 1:end));
      end
      c.address = address;
      c.module = module;
      c.octave = coopdyn.internal.is_octave();
    end

    function open(c)
    % (Re)opens the connection and sends hello.
      c.close();
      c.notice = '';
      started = tic;
      while true
        socket = coopdyn.internal.dial(c.address);
        said = strtrim(strtok(coopdyn.internal.begin(c.address, socket, ['OPEN ' c.module], '\n'), char(10)));
        if ~isempty(said) || isempty(c.address.seat) || toc(started) > c.address.timeout
          break
        end
        pause(0.2);  % the daemon of the seat is restarting
      end
      if ~strcmp(said, 'ok')
        coopdyn.internal.refuse(c.address, said);
      end
      c.socket = socket;
      if c.octave && exist('__tcpclient_read__')  % of instrument-control
        c.fast = socket;
      end
      write(socket, [uint8('CDS1') coopdyn.internal.encode(6, [], [], c.hello)]);
      c.asked = 7;
      try
        coopdyn.internal.check_reply(c.receive(c.address.timeout), '');
      catch cause
        c.close();
        rethrow(cause);
      end
    end

    function close(c)
      c.socket = [];
      c.fast = [];
      c.idle = false;
      c.buffer = zeros(1, 0, 'uint8');
      c.pushes = {};
    end

    function send(c, command, bytes)
    % Writes a request; poll or receive awaits its reply.
      c.idle = false;
      c.asked = command + 1;
      socket = c.fast;
      try
        if isempty(socket)
          write(c.socket, bytes);
        else
          __tcpclient_write__(socket, bytes);
        end
      catch
        c.lost();
      end
    end

    function message = answer(c, command)
    % The reply to the request sent last, [] if it does not arrive at once: one read of the right length.
      socket = c.fast;
      if isempty(socket)
        message = c.poll(true);
        return
      end
      try
        bytes = __tcpclient_read__(socket, c.sizes(command + 1), 20);  % called by read(), which itself takes longer than the reply
      catch
        c.lost();
      end
      n = numel(bytes);
      if n >= 24
        h = typecast(bytes(1:24), 'int32');
        at = 24 + 4 * h(5);
        if h(1) == n - 4 && h(2) == 0 && h(3) == command && h(4) == 0 && n == at + 8 * h(6)
          c.idle = true;
          params = typecast(bytes(25:at), 'int32');
          if h(5) <= 1024  % more are a picture's bytes
            params = double(params);
          end
          message = struct('error', 0, 'text', '', 'command', command, 'params', params, ...
                           'data', typecast(bytes(at + 1:n), 'double'));
          return
        end
      end
      c.buffer = bytes;
      message = c.poll(false);
    end

    function message = poll(c, wait)
    % The reply if it has arrived, else []; with `wait`, waits up to 0.02 s.
      message = [];
      while true
        have = numel(c.buffer);
        if have == 0
          want = c.sizes(c.asked);
        elseif have < 24
          want = 24 - have;
        else
          want = 4 + double(typecast(c.buffer(1:4), 'uint32')) - have;
        end
        if want > 0
          bytes = c.take(want, wait);
          if isempty(bytes)
            return
          end
          if have == 0
            c.buffer = bytes;
          else
            c.buffer = [c.buffer bytes];
          end
        end
        [message, used] = coopdyn.internal.decode(c.buffer);
        if isempty(message)
          continue
        end
        c.buffer = c.buffer(used + 1:end);
        if message.command < 0 && message.error == 0
          if message.command == -1
            c.notice = message.text;
            c.lost();
          end
          c.pushes{end + 1} = message;
          message = [];
          continue
        end
        c.idle = true;
        if message.error == 0
          c.sizes(c.asked) = 24 + 4 * numel(message.params) + 8 * numel(message.data);
        end
        return
      end
    end

    function message = receive(c, limit)
    % Waits for the reply; after `limit` seconds closes the connection and raises an error.
      message = c.poll(true);
      if ~isempty(message)
        return
      end
      started = tic;
      checked = 0;
      while true
        if toc(started) - checked > 0.5
          checked = toc(started);
          message = c.poll(true);
        else
          message = c.poll(false);
        end
        if ~isempty(message)
          return
        end
        if toc(started) > limit
          c.close();
          coopdyn.internal.fail(11, sprintf('no answer from %s within %g s; is the daemon stopped or overloaded?', ...
                                            c.module, limit));
        end
        pause(0.001);
      end
    end

    function message = request(c, command, params, data, text, limit)
    % Sends a request and returns its reply; raises an error reply.
      if nargin < 6
        limit = 10;
      end
      if nargin < 5 || isempty(text)
        if isempty(params) && isempty(data)
          bytes = typecast(int32([20 0 command 0 0 0]), 'uint8');
        else
          bytes = coopdyn.internal.encode(command, params, data);
        end
      else
        bytes = coopdyn.internal.encode(command, params, data, text);
      end
      c.send(command, bytes);
      message = c.answer(command);
      if isempty(message)
        message = c.receive(limit);
      end
      if message.error ~= 0
        coopdyn.internal.check_reply(message, '');
      end
    end

    function yes = has_bytes(c)
    % True if the connection is readable or closed.
      yes = true;
      if ~isempty(c.socket)
        try
          yes = c.socket.NumBytesAvailable > 0;
        catch
          % closed
        end
      end
    end

    function yes = alive(c)
    % False if closed, busy, or visibly closed by the peer meanwhile.
      yes = c.idle;
      if yes
        try
          if c.socket.NumBytesAvailable > 0
            c.poll(false);
          end
        catch
          yes = false;
        end
      end
    end
  end
  methods (Access = private)
    function bytes = take(c, want, wait)
      if c.octave
        if ~wait
          want = min(want, c.socket.NumBytesAvailable);
          if want == 0
            bytes = [];
            return
          end
        end
        try
          bytes = read(c.socket, want);
        catch
          c.lost();
        end
        return
      end
      % MATLAB's read warns if fewer bytes arrive: reads only the available ones.
      bytes = [];
      try
        here = c.socket.NumBytesAvailable;
        if wait && here < want
          started = tic;
          while here < want && toc(started) < 0.02
            if toc(started) > 0.002
              pause(0.0005);
            end
            here = c.socket.NumBytesAvailable;
          end
        end
        if here > 0
          bytes = uint8(read(c.socket, min(want, here), 'uint8'));
        end
      catch
        c.lost();
      end
    end

    function lost(c)
      c.close();
      if isempty(c.notice)
        coopdyn.internal.fail(-1, ['the daemon closed the connection; ' c.address.why_lost]);
      end
      coopdyn.internal.fail(-1, ['the daemon closed the connection: ' c.notice]);
    end
  end
end

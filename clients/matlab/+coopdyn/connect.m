% SPDX-License-Identifier: MIT
function sim = connect(varargin)
%CONNECT Connects to a coopdyn daemon.
%   sim = coopdyn.connect()                     this machine, or the server in COOPDYN_SERVER
%   sim = coopdyn.connect('labserver')          another machine, port 10000; 'labserver:10100' another port
%   sim = coopdyn.connect(10100)                another port of this machine
%   sim = coopdyn.connect('labserver', 'name', 'ana', 'token', 'T', 'timeout', 3, 'watch', false)
%   name: the client's name, without spaces (default user@host:pid); a client of the same name takes over robots.
%   token: printed by the daemon, needed from other machines to change the world.
%   sim = coopdyn.connect('labserver', 'seat', 'ana', 'pin', '7305')   your seat in a class (coopdyn host), as on your sheet;
%     default: COOPDYN_SEAT=ana:7305; 'seat', '': none. A PIN is a text: a number loses its leading zeros.
%   timeout: of connecting [s].   watch: read-only, never drives a robot.
%   Errors have identifiers coopdyn:owned, coopdyn:no_such_name, coopdyn:timed_out, coopdyn:connection ...
%   If another client resets the world or loads a scenario, the next reading, command or step raises coopdyn:reset, once.
%   See also coopdyn.Simulation, coopdyn.Robot, coopdyn.doctor.
  server = '';
  if mod(numel(varargin), 2) == 1
    server = varargin{1};
    varargin(1) = [];
  end
  known = struct('server', {server}, 'name', '', 'token', '', 'timeout', 3, 'watch', false, 'seat', [], 'pin', []);
  if nargin > 1 && mod(nargin, 2) == 0 && isnumeric(varargin{2}) && isscalar(varargin{2}) ...
      && coopdyn.internal.is_text(varargin{1}) && ~isfield(known, lower(char(varargin{1})))
    host = char(varargin{1});
    coopdyn.internal.fail(2, sprintf('there is no option ''%s''; there are: %s; for a port write coopdyn.connect(''%s:%d'')', ...
                                     host, strjoin(fieldnames(known)', ', '), host, varargin{2}));
  end
  options = coopdyn.internal.options(varargin, known);
  sim = coopdyn.Simulation(options);
end

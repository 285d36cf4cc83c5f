% SPDX-License-Identifier: MIT
function clients_program(server, seat, pin, varargin)
%CLIENTS_PROGRAM A student's program in a class, for clients_test.py: clients_program(SERVER, SEAT, PIN, ACTION, ...)
%   '-' for SEAT and PIN: none. Each action prints its result, or `error NAME TEXT`, and the next one follows.
  options = {};
  if ~strcmp(seat, '-')
    options = [options {'seat', seat}];
  end
  if ~strcmp(pin, '-')
    options = [options {'pin', pin}];
  end
  for k = 1:numel(varargin)
    try
      switch varargin{k}
        case 'connect'
          sim = coopdyn.connect(server, options{:});
          robot = sim.robot('robot1');
          status = sim.status();
          said = ['page ' status.http];
        case 'drive'
          robot.set_velocity(0.2, 0);
          sim.step();
          said = 'driven';
        case 'modules'
          said = sprintf('modules %d', numel(sim.modules()));
        case 'picture'
          sim.snapshot('picture.png');
          said = 'picture picture.png';
        case 'run'
          said = ['run ' sim.fetch_run(sim.stop_recording(), 'fetched.run')];
        case 'launch'
          own = coopdyn.launch('classroom', 'options', {'--no-http'});
          own.close();
          said = 'launched';
        case 'doctor'
          said = 'ill';
          if coopdyn.doctor(server, options{:})
            said = 'healthy';
          end
        case 'wait'  % for a line
          disp('waits')
          fflush(stdout);
          fgetl(stdin);
          said = 'goes on';
      end
    catch cause
      said = ['error ' strrep(cause.identifier, 'coopdyn:', '') ' ' cause.message];
    end
    disp(said)
    fflush(stdout);
  end
end

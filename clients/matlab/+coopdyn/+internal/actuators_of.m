% SPDX-License-Identifier: MIT
function [names, types] = actuators_of(session, robot)
%ACTUATORS_OF The names and types of a robot's actuator modules, in the robot's order. Queried once per world.
  known = session.actuators;
  if isempty(known) || ~any(strcmp(known(:, 1), robot))
    known = cell(0, 3);
    robots = coopdyn.internal.robots_status(session);
    for k = 1:numel(robots)
      names = {};
      types = {};
      if isfield(robots{k}, 'modules')
        for module = reshape(robots{k}.modules, 1, [])
          if any(strcmp(module.type, {'motors', 'joints', 'muscles', 'thrusters', 'channel'}))
            names{end + 1} = regexprep(module.name, '^.*/', ''); %#ok<AGROW>
            types{end + 1} = module.type; %#ok<AGROW>
          end
        end
      end
      known(end + 1, :) = {robots{k}.name, names, types}; %#ok<AGROW>
    end
    session.actuators = known;
  end
  at = find(strcmp(known(:, 1), robot), 1);
  names = {};
  types = {};
  if ~isempty(at)
    names = known{at, 2};
    types = known{at, 3};
  end
end

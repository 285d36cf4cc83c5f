% SPDX-License-Identifier: MIT
function names = modules_of(session, robot)
%MODULES_OF The names of a robot's modules by type: among several of a type, the one named like it, else the first.
  names = struct();
  robots = coopdyn.internal.robots_status(session);
  for k = 1:numel(robots)
    if ~strcmp(robots{k}.name, robot) || ~isfield(robots{k}, 'modules')
      continue
    end
    for module = reshape(robots{k}.modules, 1, [])
      name = regexprep(module.name, '^.*/', '');
      if strcmp(name, module.type) || ~isfield(names, module.type)
        names.(module.type) = name;
      end
    end
  end
end

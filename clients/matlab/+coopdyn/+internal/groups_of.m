% SPDX-License-Identifier: MIT
function groups = groups_of(session, robot)
%GROUPS_OF The names of a robot's groups of joints, in its order. Asked for once in a world.
  if isempty(session.groups) || ~any(strcmp(session.groups(:, 1), robot))
    session.groups = cell(0, 2);
    robots = coopdyn.internal.robots_status(session);
    for k = 1:numel(robots)
      names = {};
      if isfield(robots{k}, 'modules')
        for module = reshape(robots{k}.modules, 1, [])
          if strcmp(module.type, 'joints')
            names{end + 1} = regexprep(module.name, '^.*/', ''); %#ok<AGROW>
          end
        end
      end
      session.groups(end + 1, :) = {robots{k}.name, names};
    end
  end
  at = find(strcmp(session.groups(:, 1), robot), 1);
  groups = {};
  if ~isempty(at)
    groups = session.groups{at, 2};
  end
end

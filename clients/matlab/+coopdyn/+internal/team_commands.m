% SPDX-License-Identifier: MIT
function [words, rows, pairs] = team_commands(pairs)
%TEAM_COMMANDS Extracts the commands of a team from name-value pairs; returns the other pairs, too.
  known = {'velocities', 'wheels', 'positions', 'positions_direct', 'joint_velocities', 'efforts'};
  words = {};
  rows = {};
  others = {};
  for k = 1:2:numel(pairs)
    word = coopdyn.internal.word(pairs{k}, 'a command, as ''positions'',');
    if strcmpi(word, 'timeout')
      others = [others pairs(k:min(k + 1, end))]; %#ok<AGROW>
      continue
    end
    if ~any(strcmp(strtok(word, '/'), known))
      coopdyn.internal.fail(4, ['there is no command ''' word '''; there are: ' strjoin(known, ', ') ...
        '; of one group of joints: positions/arm']);
    end
    if k == numel(pairs)
      coopdyn.internal.fail(3, [word ' needs its values: a row for each robot, or one row for all']);
    end
    words{end + 1} = word; %#ok<AGROW>
    rows{end + 1} = pairs{k + 1}; %#ok<AGROW>
  end
  pairs = others;
end

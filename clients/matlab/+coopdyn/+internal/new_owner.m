% SPDX-License-Identifier: MIT
function why = new_owner(address, robot)
%NEW_OWNER Who drives a robot that was ours; '' if the daemon does not answer.
  why = '';
  try
    status = coopdyn.internal.fresh_status(address);
  catch
    return
  end
  for k = 1:numel(status.robots)
    if strcmp(status.robots(k).name, robot)
      owner = char(status.robots(k).owner);
      if isempty(owner)
        why = 'it was freed';
      else
        why = ['it is driven by ' owner];
      end
      return
    end
  end
  why = 'it is not there any more';
end

% SPDX-License-Identifier: MIT
function lose(session, link, cause)
%LOSE The daemon closed the connection for commands. If the robot was taken over or freed, the connection is not reopened:
%  that would take the robot back from its new driver. Raises the error.
  if ~strcmp(cause.identifier, 'coopdyn:connection')
    rethrow(cause);
  end
  link.forget_commands();
  if link.is_team
    why = link.connection.notice;
  else
    link.drives = false;
    why = link.motors.notice;
  end
  if isempty(why)  % Octave loses a notice that arrives together with the end of the connection
    why = new_owner(session.address, link.names{1});
  end
  if isempty(why) || (~isempty(session.address.seat) && strcmp(why, 'it was freed'))  % a restarted daemon of a seat sends this, too
    coopdyn.internal.fail(-1, ['the connection to ' link.label ' broke; ' session.address.why_lost]);
  end
  if ~isempty(regexp(why, 'is not in the new scenario$|^it is not there any more$', 'once'))
    session.new_world('load');
  end
  link.lost = [link.label ' is no longer driven by this sim: ' why '; ' link.take_again() ' takes it again'];
  link.lost_code = 6;
  if ~link.is_team
    for k = 1:numel(session.links)  % its other actuators are lost, too
      other = session.links{k};
      if strcmp(other.robot, link.robot) && isempty(other.lost) && ~other.in_team
        other.lost = link.lost;
        other.lost_code = 6;
        other.forget_commands();
        other.drives = false;
        if ~isempty(other.motors)
          other.motors.close();
        end
      end
    end
  end
  coopdyn.internal.fail(6, link.lost);
end

function why = new_owner(address, robot)
% Who drives a robot that this sim drove; '' if the daemon does not answer.
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

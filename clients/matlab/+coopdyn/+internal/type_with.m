% SPDX-License-Identifier: MIT
function [type, known] = type_with(module)
%TYPE_WITH A shipped type of robot that has a module of this kind, for messages; '' if none. known: the kind exists.
  type = '';
  known = true;
  switch module
    case {'neighbours', 'compass'}
      type = 'minibot';
    case 'support'
      type = 'transporter';
    case 'imu'
      type = 'balancer';
    case 'wrench'
      type = 'humanoid';
    case {'lidar', 'contact', 'battery', 'odometry'}
      type = 'turtle';
    case 'camera'
      type = 'coopbot_camera';
    case 'light'
      type = 'moth';
    case {'sonar', 'infrared'}
      % none
    otherwise
      known = false;
  end
end

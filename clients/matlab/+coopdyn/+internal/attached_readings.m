% SPDX-License-Identifier: MIT
function s = attached_readings(attached, reply)
%ATTACHED_READINGS Decodes the readings of the modules `attached` from a reply; targets as distance, bearing, ….
  persistent none
  if isempty(none)
    none = struct('time', 0, 'step', 0, 'distances', zeros(1, 0), 'targets', zeros(1, 0), 'target', [], ...
                  'pose', [], 'wheels', [], 'compass', [], 'support', [], 'joints', struct(), 'imu', [], ...
                  'wrench', [], 'scan', [], 'contacts', coopdyn.internal.value(260, [], '', []), 'sonar', zeros(1, 0), ...
                  'infrared', zeros(1, 0), 'light', zeros(1, 0), 'battery', [], 'odometry', []);
  end
  s = none;
  data = reply.data;
  params = reply.params;
  s.time = data(end - 1);
  s.step = data(end);
  at = 0;
  for k = 1:numel(attached)
    n = params(k + 1);
    part = data(at + 1:at + n);
    at = at + n;
    switch attached{k}
      case 'distance'
        s.distances = part;
      case 'pose'
        s.pose = struct('x', part(1), 'y', part(2), 'heading', part(3), 'forward', part(4), 'turn', part(5));
      case 'motors'
        s.wheels = struct('left_angle', part(1), 'right_angle', part(2), 'left_speed', part(3), 'right_speed', part(4));
      case 'compass'
        s.compass = part;
      case 'support'
        s.support = struct('x', part(1), 'y', part(2), 'angle', part(3));
      case 'target'
        s.targets = part;
      case 'imu'
        s.imu = coopdyn.internal.value(230, [], '', part);
      case 'wrench'
        s.wrench = coopdyn.internal.value(240, [], '', part);
      case 'lidar'
        s.scan = part;  % ranges only
      case 'contact'
        s.contacts = coopdyn.internal.value(260, [], '', part);
      case {'sonar', 'infrared', 'light'}
        s.(attached{k}) = part;
      case 'battery'
        s.battery = coopdyn.internal.value(290, [], '', part);
      case 'odometry'
        s.odometry = coopdyn.internal.value(340, [], '', part);
      otherwise  % joints/arm
        s.joints.(attached{k}(8:end)) = coopdyn.internal.value(203, [], '', part);
    end
  end
end

% SPDX-License-Identifier: MIT
function ok = pendulum(name)
%PENDULUM Balances a two-wheeled robot by its IMU and drives it one metre forward: pendulum, or pendulum('robot1').
%   Scenario pendulum. A state feedback sets the torque of the wheels' motors,
%     tau = kx (x - x_ref) + kv (v - v_ref) + kp pitch + kr rate,
%   with the pitch and its rate from the IMU, and the travelled distance x and its speed v from the wheels' joints, which turn
%   relative to the body. The gains are those of a linear-quadratic regulator for the robot's masses. At the start the robot
%   leans on a skid, and gets up. All three languages use the same algorithm and numbers.
  if nargin < 1
    name = 'robot1';
  end
  p = parameters();
  sim = coopdyn.connect();
  r = sim.robot(name);
  wheels = r.joints('wheels');
  start = sim.time;
  s = r.sense();
  before = sum(s.joints.wheels.position) / 2;
  last = s.time;
  reference = 0;
  way = 0;
  most = 0;
  while s.time - start < p.end
    t = s.time - start;
    imu = s.imu;
    pitch = asin(max(-1, min(1, 2 * (imu.qw * imu.qy - imu.qz * imu.qx))));
    way = p.wheel_radius * (sum(s.joints.wheels.position) / 2 - before + pitch);
    speed = p.wheel_radius * (sum(s.joints.wheels.velocity) / 2 + imu.wy);
    speed_reference = 0;
    if t >= p.stand_until && t < p.drive_until
      speed_reference = p.speed;
    end
    reference = reference + speed_reference * (s.time - last);
    last = s.time;
    torque = p.position_gain * (way - reference) + p.speed_gain * (speed - speed_reference) + p.pitch_gain * pitch ...
             + p.rate_gain * imu.wy;
    torque = max(-p.max_torque, min(p.max_torque, torque));
    wheels.set_efforts(torque / 2);
    if t >= p.stand_until
      most = max(most, abs(pitch));
    end
    sim.step();
    s = r.sense();
  end
  fprintf('%s went %.3f m and leaned at most %.2f degrees after it had got up\n', name, way, most * 180 / pi);
  sim.close();
  if nargout > 0
    ok = most < 0.2;
  end
end

function p = parameters()
  p.wheel_radius = 0.05;   % [m]
  p.position_gain = 0.27;  % kx [N m/m]
  p.speed_gain = 0.36;     % kv [N m s/m]
  p.pitch_gain = 2.12;     % kp [N m/rad]
  p.rate_gain = 0.24;      % kr [N m s/rad]
  p.max_torque = 1.0;      % [N m] both wheels together
  p.speed = 0.25;          % [m/s]
  p.stand_until = 4.0;     % [s] simulated, from the start of the program
  p.drive_until = 8.0;     % [s]
  p.end = 14.0;            % [s]
end

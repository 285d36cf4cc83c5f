% SPDX-License-Identifier: MIT
classdef SensorCalls < handle
%SENSORCALLS Readings of the sensors of robot models. Part of coopdyn.Robot.
%   Each is for robots with a module of its type; pass the module's name for another of the same type:
%   r.get_image('left_camera').
  properties (Access = protected)
    session
    link
  end
  methods
    function v = get_imu(r, module)
    %GET_IMU The sensor's orientation in the world as a quaternion qw, qx, qy, qz; angular velocity wx, wy, wz [rad/s] and
    %   acceleration ax, ay, az [m/s2] in the sensor's frame: at rest and level, az = 9.81.
      if nargin < 2, module = 'imu'; end
      v = r.get(char(module), 230, [], '');
    end

    function v = get_wrench(r, module)
    %GET_WRENCH Force fx, fy, fz [N] and torque tx, ty, tz [N m] through a joint, in the sensor's frame.
      if nargin < 2, module = 'wrench'; end
      v = r.get(char(module), 240, [], '');
    end

    function s = get_scan(r, module)
    %GET_SCAN The ranges of a lidar [m], one row per row of rays, the lowest first, from right to left; inf = nothing in range,
    %   0 = nearer than min_range. azimuth [rad] of each column, left positive; elevation [rad] of each row, up positive;
    %   min_range and max_range [m].
      if nargin < 2, module = 'lidar'; end
      s = r.scan(char(module), r.get(char(module), 250, [], ''));
    end

    function c = get_contacts(r, module)
    %GET_CONTACTS The contacts of the sensor, a 1 x n struct: id (0: the floor) and name, force [N], point x, y, z [m] and the
    %   direction nx, ny, nz of the force on the robot, in the robot's frame.
      if nargin < 2, module = 'contact'; end
      c = r.get(char(module), 260, [], '');
    end

    function pressed = get_bumper(r, module)
    %GET_BUMPER Whether each zone of the bumper is pressed, right to left; a row of true and false.
      if nargin < 2, module = 'contact'; end
      pressed = r.get(char(module), 261, [], '');
    end

    function [image, time, step] = get_image(r, module)
    %GET_IMAGE A camera's colour picture: height x width x 3 uint8, as for imshow and imwrite. Taken at time [s] in step: if the
    %   camera has a rate, its latest picture.
      if nargin < 2, module = 'camera'; end
      [image, time, step] = r.picture(char(module), 0);
    end

    function [bytes, time, step] = get_jpeg(r, module)
    %GET_JPEG The same as the bytes of a JPEG file, a row of uint8.
      if nargin < 2, module = 'camera'; end
      [bytes, time, step] = r.picture(char(module), 1);
    end

    function [depth, time, step] = get_depth(r, module)
    %GET_DEPTH The distance of each pixel along the camera's axis [m]: height x width single; inf = nothing there.
      if nargin < 2, module = 'camera'; end
      [depth, time, step] = r.picture(char(module), 2);
    end

    function [labels, names, time, step] = get_segmentation(r, module)
    %GET_SEGMENTATION The object that each pixel shows, as a number: height x width uint16, 0 = nothing; and the objects' names,
    %   a 1 x n struct with id and name.
      if nargin < 2, module = 'camera'; end
      [labels, time, step, text] = r.picture(char(module), 3);
      pairs = regexp(text, '(\d+)=(\S+)', 'tokens');
      names = struct('id', {}, 'name', {});
      for k = 1:numel(pairs)
        names(1, k) = struct('id', str2double(pairs{k}{1}), 'name', pairs{k}{2});
      end
    end

    function c = get_camera(r, module)
    %GET_CAMERA width, height, focal lengths fx, fy and principal point cx, cy of the picture [pixels], near and far limit of the
    %   view [m], and rate [Hz; 0 = each step].
      if nargin < 2, module = 'camera'; end
      c = r.get(char(module), 271, [], '');
    end

    function b = get_battery(r, module)
    %GET_BATTERY Remaining energy [J] and fraction [0 to 1], and the power drawn [W].
      if nargin < 2, module = 'battery'; end
      b = r.get(char(module), 290, [], '');
    end

    function l = get_light(r, module)
    %GET_LIGHT The brightness that each light sensor measures.
      if nargin < 2, module = 'light'; end
      l = r.get(char(module), 310, [], '');
    end

    function d = get_sonar(r, module)
    %GET_SONAR One range per sonar [m]; inf = nothing in range, 0 = nearer than the minimum.
      if nargin < 2, module = 'sonar'; end
      d = r.get(char(module), 320, [], '');
    end

    function v = get_infrared(r, module)
    %GET_INFRARED The output of each infrared sensor, by its curve.
      if nargin < 2, module = 'infrared'; end
      v = r.get(char(module), 330, [], '');
    end

    function o = get_odometry(r, module)
    %GET_ODOMETRY x, y [m], heading [rad] since the start, forward [m/s] and turn [rad/s], by the wheels' encoders.
      if nargin < 2, module = 'odometry'; end
      o = r.get(char(module), 340, [], '');
    end
  end
  methods (Access = protected)
    function v = get(r, module, command, params, text)
      reply = r.session.read(r.link, module, command, params, text);
      v = coopdyn.internal.value(command, reply.params, reply.text, reply.data(1:end - 2));
    end

    function s = scan(r, module, ranges)
    % The angles are queried once.
      link = r.link;
      if ~isfield(link.scans, module) || link.scans.(module).rows * link.scans.(module).columns ~= numel(ranges)
        link.scans.(module) = r.get(module, 251, [], '');
      end
      g = link.scans.(module);
      s = struct('ranges', reshape(ranges, g.columns, g.rows).', ...
                 'azimuth', g.first + g.increment * (0:g.columns - 1), 'elevation', g.low + g.step * (0:g.rows - 1), ...
                 'min_range', g.min_range, 'max_range', g.max_range);
    end

    function [image, time, step, text] = picture(r, module, kind)
      reply = r.session.read(r.link, module, 270, kind, '');
      image = coopdyn.internal.image_value(reply.params, kind);
      time = reply.data(end - 1);
      step = reply.data(end);
      text = reply.text;
    end
  end
end

% SPDX-License-Identifier: MIT
function v = value(command, params, text, data)
%VALUE Decodes the reply to the get command of this number (data without time and step).
  switch command
    case 12
      v = struct('left_angle', data(1), 'right_angle', data(2), 'left_speed', data(3), 'right_speed', data(4));
    case 13
      v = struct('max_wheel_speed', data(1), 'wheel_radius', data(2), 'track', data(3));
    case 21
      v = struct('bearing', data(1:3:end), 'opening', data(2:3:end), 'max_range', data(3:3:end));
    case {30, 32, 200}
      word = 'colour';
      if command ~= 30
        word = 'name';
      end
      words = strsplit(strtrim(text), ' ');
      v = coopdyn.internal.sightings(params, word, words, data);
    case 202
      v = struct('id', {}, 'distance', {}, 'bearing', {}, 'values', {});
      at = 0;
      for k = 1:numel(params) / 2
        count = params(2 * k);
        v(1, k) = struct('id', params(2 * k - 1), 'distance', data(at + 1), 'bearing', data(at + 2), ...
                         'values', data(at + 3:at + 2 + count));
        at = at + 2 + count;
      end
    case 203
      v = struct('position', data(1:3:end), 'velocity', data(2:3:end), 'effort', data(3:3:end));
    case 209
      words = {'idle', 'position', 'direct', 'velocity', 'effort', 'pwm'};
      v = words(params + 1);
    case 211
      v = struct('k', data(1:3:end), 'd', data(2:3:end), 'offset', data(3:3:end));
    case 213
      v = struct('speed', data(1:2:end), 'acceleration', data(2:2:end));
    case 215
      v = struct('p', data(1:3:end), 'i', data(2:3:end), 'd', data(3:3:end));
    case 216
      v = struct('lower', data(1:4:end), 'upper', data(2:4:end), 'velocity', data(3:4:end), 'effort', data(4:4:end));
    case 217
      v = struct('arrived', params ~= 0, 'target', data);
    case 223
      v = struct('rotor_position', data(1:4:end), 'rotor_velocity', data(2:4:end), 'current', data(3:4:end), ...
                 'energy', data(4:4:end));
    case 225
      v = struct('activation', data(1:6:end), 'force', data(2:6:end), 'length', data(3:6:end), 'velocity', data(4:6:end), ...
                 'length_factor', data(5:6:end), 'velocity_factor', data(6:6:end));
    case 226
      v = struct('max_force', data(1:3:end), 'optimal_length', data(2:3:end), 'max_velocity', data(3:3:end));
    case 228
      v = struct('thrust', data(1:2:end), 'velocity', data(2:2:end));
    case 229
      v = struct('max_thrust', data);
    case 230
      v = struct('qw', data(1), 'qx', data(2), 'qy', data(3), 'qz', data(4), 'wx', data(5), 'wy', data(6), 'wz', data(7), ...
                 'ax', data(8), 'ay', data(9), 'az', data(10));
    case 240
      v = struct('fx', data(1), 'fy', data(2), 'fz', data(3), 'tx', data(4), 'ty', data(5), 'tz', data(6));
    case 251
      v = struct('first', data(1), 'increment', data(2), 'min_range', data(3), 'max_range', data(4), 'rows', data(5), ...
                 'columns', data(6), 'low', data(7), 'step', data(8));
    case 260
      names = strsplit(strtrim(text), ' ');
      v = struct('id', {}, 'name', {}, 'force', {}, 'x', {}, 'y', {}, 'z', {}, 'nx', {}, 'ny', {}, 'nz', {});
      for k = 1:numel(data) / 7
        d = data(7 * k - 6:7 * k);
        v(1, k) = struct('id', -1, 'name', '', 'force', d(1), 'x', d(2), 'y', d(3), 'z', d(4), 'nx', d(5), 'ny', d(6), ...
                         'nz', d(7));
        if numel(params) >= k && numel(names) >= k
          v(k).id = params(k);
          v(k).name = names{k};
        end
      end
    case 261
      v = data ~= 0;
    case 271
      v = struct('width', data(1), 'height', data(2), 'fx', data(3), 'fy', data(4), 'cx', data(5), 'cy', data(6), ...
                 'near', data(7), 'far', data(8), 'rate', data(9));
    case 290
      v = struct('energy', data(1), 'fraction', data(2), 'power', data(3));
    case 340
      v = struct('x', data(1), 'y', data(2), 'heading', data(3), 'forward', data(4), 'turn', data(5));
    case 280
      v = struct('x', data(1), 'y', data(2), 'angle', data(3));
    case 31
      v = struct('distance', data(1), 'bearing', data(2));
    case 40
      v = struct('x', data(1), 'y', data(2), 'heading', data(3), 'forward', data(4), 'turn', data(5));
    case 41
      v = struct('x', data(1), 'y', data(2), 'z', data(3), 'qw', data(4), 'qx', data(5), 'qy', data(6), ...
                 'qz', data(7), 'vx', data(8), 'vy', data(9), 'vz', data(10), 'wx', data(11), 'wy', data(12), ...
                 'wz', data(13));
    otherwise
      v = data;
  end
end

% SPDX-License-Identifier: MIT
function v = value(command, params, text, data)
%VALUE What the get-command of this number returns, out of its message (data without time and step).
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
      words = {'idle', 'position', 'direct', 'velocity', 'effort'};
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

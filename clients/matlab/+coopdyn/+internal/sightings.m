% SPDX-License-Identifier: MIT
function v = sightings(ids, word, words, data)
%SIGHTINGS A 1 x n struct of targets or robots: id, colour or name, distance [m], bearing [rad].
  n = min([numel(ids), numel(words), floor(numel(data) / 2)]);
  if n == 0
    v = struct('id', {}, word, {}, 'distance', {}, 'bearing', {});
    v = reshape(v, 1, 0);
    return
  end
  v = struct('id', num2cell(ids(1:n)), word, words(1:n), 'distance', num2cell(data(1:2:2 * n)), ...
             'bearing', num2cell(data(2:2:2 * n)));
end

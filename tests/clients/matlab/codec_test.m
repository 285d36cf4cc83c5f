% SPDX-License-Identifier: MIT
% needs: nothing
% Every golden vector is encoded to its bytes and decoded to its values; cut ones need more; bad ones are errors.
folder = fullfile(getenv('COOPDYN_ROOT'), 'tests', 'protocol', 'vectors');
vectors = jsondecode(fileread(fullfile(folder, 'messages.json')));
assert(numel(vectors) > 20);
for k = 1:numel(vectors)
  if iscell(vectors), v = vectors{k}; else, v = vectors(k); end
  raw = uint8(sscanf(v.binary_hex, '%2x')');
  data = zeros(1, 0);
  for j = 1:numel(v.data)
    data(j) = str2double(v.data{j});
  end
  params = reshape(double(v.params), 1, []);
  if v.error == 0 && ~any(isnan(data))
    mine = coopdyn.internal.encode(v.command, params, data, v.text);
    assert(isequal(mine, raw), ['encode ' v.name]);
  end
  [m, used] = coopdyn.internal.decode([raw uint8(1:5)]);
  assert(used == numel(raw), v.name);
  assert(isequal([m.error m.command], [v.error v.command]), v.name);
  assert(isequal(m.params, params) || (isempty(m.params) && isempty(params)), v.name);
  assert(isequaln_row(m.data, data), v.name);
  assert(strcmp(m.text, v.text), ['text of ' v.name]);
end
raw = coopdyn.internal.encode(11, [1 2], 0.5, 'text');
for cut = 0:numel(raw) - 1
  [m, used] = coopdyn.internal.decode(raw(1:cut));
  assert(isempty(m) && used == 0);
end
bad = jsondecode(fileread(fullfile(folder, 'bad_binary.json')));
tried = 0;
for k = 1:numel(bad)
  if iscell(bad), v = bad{k}; else, v = bad(k); end
  raw = uint8(sscanf(v.hex, '%2x')');
  if v.fatal && v.needs == 24 && numel(raw) >= 24
    expect_error('coopdyn:malformed', @() coopdyn.internal.decode(raw));
    tried = tried + 1;
  end
end
assert(tried > 3);
disp('passed')

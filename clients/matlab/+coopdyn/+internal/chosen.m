% SPDX-License-Identifier: MIT
function ids = chosen(parts, names, one, whose)
%CHOSEN Ids of joints or other parts, from names or ids; [] are all. `one`: their singular, e.g. 'joint'.
  n = numel(names);
  if isempty(parts)
    ids = 1:n;
    return
  end
  if isnumeric(parts)
    ids = reshape(double(parts), 1, []);
    if ~all(ids == round(ids) & ids >= 1 & ids <= n)
      coopdyn.internal.fail(4, [whose ' has the ' one 's 1 to ' num2str(n) ', not ' coopdyn.internal.show(parts)]);
    end
  else
    parts = cellstr(parts);
    ids = zeros(1, 0);
    for k = 1:numel(parts)
      at = reshape(find(strcmp(names, parts{k})), 1, []);  % values of a channel may share a name
      if isempty(at)
        coopdyn.internal.fail(10, [whose ' has no ' one ' ''' parts{k} '''; ' coopdyn.internal.nearest(parts{k}, names) ...
          'there are: ' coopdyn.internal.list_of(names)]);
      end
      ids = [ids at]; %#ok<AGROW>
    end
  end
  if numel(unique(ids)) < numel(ids)
    coopdyn.internal.fail(2, ['name each ' one ' once; there are: ' coopdyn.internal.list_of(names)]);
  end
end

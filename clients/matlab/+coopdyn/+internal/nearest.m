% SPDX-License-Identifier: MIT
function text = nearest(name, known)
%NEAREST Suggests, as part of an error, the known name most similar to a name, ignoring case.
  text = '';
  least = max(1, floor(0.3 * numel(name)));  % edits that still count as a typo
  for k = 1:numel(known)
    edits = distance(lower(name), lower(known{k}));
    if edits < least || edits == least && isempty(text)
      least = edits;
      text = ['did you mean ' known{k} '? '];
    end
  end
end

function edits = distance(a, b)
% The edit distance: letters to insert, remove or replace between two words.
  row = 0:numel(b);
  for i = 1:numel(a)
    before = row;
    row(1) = i;
    for j = 1:numel(b)
      row(j + 1) = min([before(j + 1) + 1, row(j) + 1, before(j) + (a(i) ~= b(j))]);
    end
  end
  edits = row(end);
end

% SPDX-License-Identifier: MIT
function quoted = url_quoted(text)
%URL_QUOTED A name as a part of a URL: UTF-8, with %20 for a blank.
  bytes = reshape(double(unicode2native(text, 'UTF-8')), 1, []);
  plain = ismember(bytes, double(['a':'z' 'A':'Z' '0':'9' '-._~']));
  parts = cell(1, numel(bytes));
  parts(plain) = num2cell(char(bytes(plain)));
  parts(~plain) = arrayfun(@(b) sprintf('%%%02X', b), bytes(~plain), 'UniformOutput', false);
  quoted = [parts{:}];
end

% SPDX-License-Identifier: MIT
function url = url_here(address, url)
%URL_HERE The same URL with the host that reaches the daemon from here; '' if there is none.
  found = regexp(url, '^\w+://.*?:(\d+)(/.*)?$', 'tokens', 'once');
  if isempty(found)
    url = '';
    return
  end
  host = address.host;
  if any(host == ':')
    host = ['[' host ']'];
  end
  path = '';
  if numel(found) > 1
    path = found{2};
  end
  url = ['http://' host ':' found{1} path];
end

% SPDX-License-Identifier: MIT
function url = url_here(address, url)
%URL_HERE The URL with the host by which this machine reaches the daemon; '' without a URL.
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

% SPDX-License-Identifier: MIT
function n = sockets()
%SOCKETS How many sockets this process has open.
  [~, listing] = system(sprintf('ls -l /proc/%d/fd', getpid()));
  n = numel(strfind(listing, 'socket:'));
end

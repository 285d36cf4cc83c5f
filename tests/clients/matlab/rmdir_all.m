% SPDX-License-Identifier: MIT
function rmdir_all(folder)
%RMDIR_ALL Removes a folder with what is in it, without asking.
  if exist('confirm_recursive_rmdir', 'builtin') || exist('confirm_recursive_rmdir') %#ok<EXIST>
    confirm_recursive_rmdir(false, 'local');
  end
  rmdir(folder, 's');
end

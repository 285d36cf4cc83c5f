% SPDX-License-Identifier: MIT
function rmdir_all(folder)
%RMDIR_ALL Removes a folder with its contents, without asking.
  if exist('confirm_recursive_rmdir', 'builtin') || exist('confirm_recursive_rmdir') %#ok<EXIST>
    confirm_recursive_rmdir(false, 'local');
  end
  rmdir(folder, 's');
end

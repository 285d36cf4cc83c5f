% SPDX-License-Identifier: MIT
function yes = is_running(process)
%IS_RUNNING Whether the process of this number runs (Linux). False for a zombie.
  [~, words] = system(sprintf('tr -d ''\\0'' 2>/dev/null </proc/%d/cmdline', process));
  yes = ~isempty(strtrim(words));
end

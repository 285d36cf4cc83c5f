// SPDX-License-Identifier: MIT
#include "server/timing/cpu_users.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <system_error>

#include "server/base/printable.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

/// The next word, which is taken off `text`.
std::string_view NextWord(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \n"), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(" \n"));
  text.remove_prefix(word.size());
  return word;
}

/// A whole number; 0 if it is none.
std::int64_t Number(std::string_view word) {
  std::int64_t value = 0;
  std::from_chars(word.data(), word.data() + word.size(), value);
  return value;
}

std::string ReadText(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Of the folders in `folder` whose names are numbers. What ends meanwhile is left out.
std::vector<CpuUser> ReadUsers(const fs::path& folder, Nanoseconds tick) {
  std::vector<CpuUser> users;
  std::error_code failed;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) {
    if (Number(it->path().filename().string()) <= 0) continue;
    if (auto user = ParseProcessStat(ReadText(it->path() / "stat"), tick)) users.push_back(*std::move(user));
  }
  return users;
}

}  // namespace

std::optional<CpuUser> ParseProcessStat(std::string_view text, Nanoseconds tick) {
  // 4711 (a name) with) any) signs) S 1 …: user and system time are the 12th and 13th word after the name.
  const std::size_t open = text.find('('), close = text.rfind(')');
  if (open == std::string_view::npos || close == std::string_view::npos || close < open) return std::nullopt;
  CpuUser user;
  user.id = Number(text.substr(0, open));
  user.name = Printable(std::string(text.substr(open + 1, close - open - 1)));
  std::string_view rest = text.substr(close + 1);
  for (int i = 0; i < 11; ++i) NextWord(rest);
  const std::int64_t user_ticks = Number(NextWord(rest)), system_ticks = Number(NextWord(rest));
  user.cpu = (user_ticks + system_ticks) * tick;
  if (user.id <= 0) return std::nullopt;
  return user;
}

Nanoseconds ParseBusyTime(std::string_view text, Nanoseconds tick) {
  if (NextWord(text) != "cpu") return 0;
  std::int64_t busy = 0;
  // user nice system idle iowait irq softirq steal
  for (int i = 0; i < 8; ++i) {
    const std::int64_t ticks = Number(NextWord(text));
    if (i != 3 && i != 4) busy += ticks;
  }
  return busy * tick;
}

CpuUse ReadCpuUse() {
  const Nanoseconds tick = kNanosecondsPerSecond / std::max(1L, sysconf(_SC_CLK_TCK));
  CpuUse use;
  use.others = ReadUsers("/proc", tick);
  std::erase_if(use.others, [own = ::getpid()](const CpuUser& user) { return user.id == own; });
  use.threads = ReadUsers("/proc/self/task", tick);
  use.busy = ParseBusyTime(ReadText("/proc/stat"), tick);
  return use;
}

std::vector<CpuShare> SharesOf(const std::vector<CpuUser>& before, const std::vector<CpuUser>& after,
                               Nanoseconds wall) {
  std::map<std::int64_t, Nanoseconds> from;
  for (const CpuUser& user : before) from[user.id] = user.cpu;
  std::map<std::string, CpuShare> by_name;
  for (const CpuUser& user : after) {
    const auto found = from.find(user.id);
    const Nanoseconds used = user.cpu - (found == from.end() ? 0 : found->second);
    if (used <= 0) continue;
    CpuShare& share = by_name[user.name];
    share.name = user.name;
    ++share.count;
    share.cores += static_cast<double>(used) / static_cast<double>(std::max<Nanoseconds>(wall, 1));
  }
  std::vector<CpuShare> shares;
  for (auto& [name, share] : by_name) shares.push_back(std::move(share));
  std::stable_sort(shares.begin(), shares.end(),
                   [](const CpuShare& a, const CpuShare& b) { return a.cores > b.cores; });
  return shares;
}

}  // namespace coopdyn

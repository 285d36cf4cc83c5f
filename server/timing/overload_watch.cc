// SPDX-License-Identifier: MIT
#include "server/timing/overload_watch.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <system_error>
#include <utility>
#include <vector>

#include "server/base/printable.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

/// Removes and returns the first word of `text`.
std::string_view NextWord(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \n"), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(" \n"));
  text.remove_prefix(word.size());
  return word;
}

/// The whole number in `word`; 0 if it is none.
std::int64_t Number(std::string_view word) {
  std::int64_t value = 0;
  std::from_chars(word.data(), word.data() + word.size(), value);
  return value;
}

std::string ReadText(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// For the folders in `folder` whose names are numbers; skips processes that end meanwhile.
std::vector<CpuUser> ReadUsers(const fs::path& folder, Nanoseconds tick) {
  std::vector<CpuUser> users;
  std::error_code failed;
  for (fs::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) {
    if (Number(it->path().filename().string()) <= 0) continue;
    if (auto user = ParseProcessStat(ReadText(it->path() / "stat"), tick)) users.push_back(*std::move(user));
  }
  return users;
}

constexpr std::size_t kNamed = 3;
constexpr double kLeastShare = 0.05;   // of a core; smaller shares are not named
constexpr double kOthersMatter = 0.5;  // cores

double Milliseconds(double ns) {
  return ns * 1e-6;
}

/// "50 python3 160 %, firefox 12 %"
std::string NameShares(const std::vector<CpuShare>& shares) {
  std::string text;
  for (std::size_t i = 0; i < std::min(shares.size(), kNamed); ++i) {
    const CpuShare& share = shares[i];
    if (share.cores < kLeastShare) break;
    const std::string count = share.count > 1 ? fmt::format("{} ", share.count) : "";
    text += fmt::format("{}{}{} {:.0f} %", text.empty() ? "" : ", ", count, share.name, 100 * share.cores);
  }
  return text;
}

double Cores(const std::vector<CpuShare>& shares) {
  double cores = 0;
  for (const CpuShare& share : shares) cores += share.cores;
  return cores;
}

double PeriodOf(const RunStatus& status) {
  return static_cast<double>(status.step_length) / status.speed;
}

}  // namespace

std::optional<CpuUser> ParseProcessStat(std::string_view text, Nanoseconds tick) {
  // "4711 (a name) with) any) signs) S 1 …": user and system time are words 12 and 13 after the name.
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

namespace {

Nanoseconds ClockTick() {
  return kNanosecondsPerSecond / std::max(1L, sysconf(_SC_CLK_TCK));
}

}  // namespace

std::vector<CpuUser> ReadThreadUse() {
  return ReadUsers("/proc/self/task", ClockTick());
}

CpuUse ReadCpuUse() {
  const Nanoseconds tick = ClockTick();
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

double LostPart(const RunStatus& before, const RunStatus& after, Nanoseconds wall) {
  if (after.mode != Mode::kRealtime || after.speed <= 0 || wall <= 0) return 0;
  if (after.late_periods < before.late_periods) return 0;  // another run or playback counts from 0
  const auto periods = static_cast<double>(after.late_periods - before.late_periods);
  return periods * PeriodOf(after) / static_cast<double>(wall);
}

std::string DescribeSteps(const RunStatus& before, const RunStatus& after) {
  const double steps = static_cast<double>(after.simulated - before.simulated) /
                       static_cast<double>(std::max<Nanoseconds>(after.step_length, 1));
  if (steps < 1) return {};
  const PhaseTimes &from = before.load.times, &to = after.load.times;
  std::array<std::pair<double, const char*>, 4> parts{{
      {static_cast<double>(to.physics - from.physics), "physics"},
      {static_cast<double>(to.sense - from.sense), "sensing for controllers"},
      {static_cast<double>(to.control - from.control), "controllers"},
      {static_cast<double>(to.publish - from.publish), "making frames"},
  }};
  double all = 0;
  for (auto& [time, name] : parts) all += time /= steps;
  std::sort(parts.rbegin(), parts.rend());
  std::string text = fmt::format(
      "A step is due every {:.3g} ms and takes {:.2g} ms, most of it {} ({:.2g} ms)",
      Milliseconds(PeriodOf(after)), Milliseconds(all), parts[0].second, Milliseconds(parts[0].first));
  if (!after.load.controller.empty()) {
    text += fmt::format("; of the controllers {} takes most ({:.2g} ms)", after.load.controller,
                        Milliseconds(static_cast<double>(after.load.controller_step)));
  }
  return text + ".";
}

std::string DescribeOthers(const CpuUse& before, const CpuUse& after, Nanoseconds wall) {
  const std::vector<CpuShare> others = SharesOf(before.others, after.others, wall);
  const std::vector<CpuShare> own = SharesOf(before.threads, after.threads, wall);
  const double busy = static_cast<double>(after.busy - before.busy) / static_cast<double>(wall);
  const double hidden = busy - Cores(others) - Cores(own);
  const std::string threads = NameShares(own).empty() ? "" : " Threads of coopdyn: " + NameShares(own) + ".";
  if (Cores(others) >= kOthersMatter) {
    return "Other programs keep the cores busy: " + NameShares(others) + "." + threads;
  }
  if (hidden < kOthersMatter) return {};
  return fmt::format("Something that is not visible from here keeps the cores busy: {:.0f} %.",
                     100 * hidden) +
         threads;
}

std::string OverloadWatch::Look(Nanoseconds now, const RunStatus& status) {
  if (from_ && now - from_->now < kWindow) return {};
  const std::optional<Moment> from = std::exchange(from_, Moment{now, status});
  if (!from) return {};
  const Nanoseconds wall = now - from->now;
  const double lost = LostPart(from->status, status, wall);
  const bool warned_lately = warned_at_ && now - *warned_at_ < kAgainAfter;
  if (lost <= kMostLost || warned_lately) {
    use_.reset();
    return {};
  }
  const std::optional<CpuUse> before = std::exchange(use_, read_use_());
  if (!before) return {};
  warned_at_ = now;
  std::string text =
      fmt::format("real time is lost: {:.0f} % in the last {:.0f} s. ", 100 * lost, ToSeconds(wall));
  text += DescribeSteps(from->status, status);
  const std::string others = DescribeOthers(*before, *use_, wall);
  use_.reset();
  if (others.empty()) return text + " Use fewer robots, a simpler fidelity, --threads or a longer step.";
  text += " " + others;
  if (status.load.priority_refused) {
    text += " Let coopdyn go first: `ulimit -e 30` before it starts, or LimitNICE=-10 in its systemd unit.";
  }
  return text;
}

}  // namespace coopdyn

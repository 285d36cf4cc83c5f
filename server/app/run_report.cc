// SPDX-License-Identifier: MIT
#include "server/app/run_report.h"

#include <spdlog/fmt/fmt.h>
#include <algorithm>
#include <boost/json.hpp>
#include <cmath>

#include "server/app/options.h"

namespace coopdyn {

namespace {

/// "45 s", "12 min" or "3.1 h".
std::string Rough(double seconds) {
  constexpr double kMinute_s = 60, kHour_s = 3600;
  if (seconds < 2 * kMinute_s) return fmt::format("{:.0f} s", seconds);
  if (seconds < 2 * kHour_s) return fmt::format("{:.0f} min", seconds / kMinute_s);
  return fmt::format("{:.1f} h", seconds / kHour_s);
}

}  // namespace

std::string ProgressLine(const Frame& frame, const RunStatus& status, double duration_s) {
  const std::string of = duration_s > 0 ? fmt::format(" of {:g}", duration_s) : "";
  std::string line = fmt::format("t = {:.2f}{} s  step {}  real-time factor {:.2f}", frame.time_s(), of,
                                 frame.step, status.real_time_factor);
  if (duration_s > frame.time_s() && status.real_time_factor > 0) {
    line += "  " + Rough((duration_s - frame.time_s()) / status.real_time_factor) + " left";
  }
  return line;
}

std::string ProgressBar(const Frame& frame, const RunStatus& status, double duration_s) {
  constexpr int kWidth = 40;
  const int done = std::clamp(static_cast<int>(std::lround(kWidth * frame.time_s() / duration_s)), 0, kWidth);
  return fmt::format("[{}{}] {}", std::string(static_cast<std::size_t>(done), '#'),
                     std::string(static_cast<std::size_t>(kWidth - done), '.'),
                     ProgressLine(frame, status, duration_s));
}

std::string SummaryLine(const Frame& frame, const RunStatus& status, double wall_s) {
  const std::size_t robots = frame.scene->robots.size();
  std::string line =
      fmt::format("{} steps of {} robot{}, t = {:.2f} s in {:.2f} s, real-time factor {:.2f}, hash {}",
                  frame.step, robots, robots == 1 ? "" : "s", frame.time_s(), wall_s,
                  wall_s > 0 ? frame.time_s() / wall_s : 0, HashText(StateHash(frame)));
  constexpr std::size_t kNamed = 20;
  for (std::size_t i = 0; i < std::min(status.frozen.size(), kNamed); ++i) {
    line += (i == 0 ? ", frozen: " : ", ") + status.frozen[i];
  }
  if (status.frozen.size() > kNamed) {
    line += fmt::format(" and {} more", status.frozen.size() - kNamed);
  } else if (status.frozen.empty()) {
    line += ", nothing frozen";
  }
  return line;
}

std::string SummaryJson(const Frame& frame, const RunStatus& status, double wall_s) {
  boost::json::array frozen;
  for (const std::string& name : status.frozen) frozen.emplace_back(name);
  const double factor = wall_s > 0 ? frame.time_s() / wall_s : 0;
  return boost::json::serialize(boost::json::object{{"version", kVersion},
                                                    {"scenario", frame.scene->scenario->name},
                                                    {"seed", frame.seed},
                                                    {"mode", ToString(status.mode)},
                                                    {"robots", frame.scene->robots.size()},
                                                    {"steps", frame.step},
                                                    {"time_s", frame.time_s()},
                                                    {"wall_s", wall_s},
                                                    {"rtf", factor},
                                                    {"late_periods", status.late_periods},
                                                    {"hash", HashText(StateHash(frame))},
                                                    {"frozen", std::move(frozen)}}) +
         "\n";
}

}  // namespace coopdyn

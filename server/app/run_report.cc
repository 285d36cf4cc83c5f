// SPDX-License-Identifier: MIT
#include "server/app/run_report.h"

#include <spdlog/fmt/fmt.h>
#include <algorithm>
#include <boost/json.hpp>
#include <cmath>

#include "server/app/options.h"

namespace coopdyn {

std::string ProgressLine(const Frame& frame, const RunStatus& status) {
  return fmt::format("t = {:.2f} s  step {}  real-time factor {:.2f}", frame.time_s(), frame.step,
                     status.real_time_factor);
}

std::string ProgressBar(const Frame& frame, const RunStatus& status, double duration_s) {
  constexpr int kWidth = 40;
  const int done = std::clamp(static_cast<int>(std::lround(kWidth * frame.time_s() / duration_s)), 0, kWidth);
  return fmt::format("[{}{}] {}", std::string(static_cast<std::size_t>(done), '#'),
                     std::string(static_cast<std::size_t>(kWidth - done), '.'), ProgressLine(frame, status));
}

std::string SummaryLine(const Frame& frame, const RunStatus& status, double wall_s) {
  std::string line =
      fmt::format("{} steps, t = {:.2f} s, real-time factor {:.2f}, hash {}", frame.step, frame.time_s(),
                  wall_s > 0 ? frame.time_s() / wall_s : 0, HashText(StateHash(frame)));
  for (const std::string& name : status.frozen) line += ", frozen: " + name;
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

// SPDX-License-Identifier: MIT
#include "server/app/run_report.h"

#include <spdlog/fmt/fmt.h>
#include <algorithm>
#include <boost/json.hpp>

#include "server/app/options.h"
#include "server/app/progress_text.h"

namespace coopdyn {

std::string ProgressLine(const Frame& frame, const RunStatus& status, double duration_s) {
  const std::string of = duration_s > 0 ? fmt::format(" of {:g}", duration_s) : "";
  std::string line = fmt::format("t = {:.2f}{} s  step {}  real-time factor {:.2f}", frame.time_s(), of,
                                 frame.step, status.real_time_factor);
  if (duration_s > frame.time_s() && status.real_time_factor > 0) {
    line += "  " + LeftText((duration_s - frame.time_s()) / status.real_time_factor);
  }
  return line;
}

std::string ProgressWithBar(const Frame& frame, const RunStatus& status, double duration_s) {
  return BarText(frame.time_s() / duration_s) + " " + ProgressLine(frame, status, duration_s);
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

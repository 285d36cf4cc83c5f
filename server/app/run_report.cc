// SPDX-License-Identifier: MIT
#include "server/app/run_report.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <boost/json.hpp>
#include <filesystem>
#include <fstream>
#include <vector>

#include "protocol/json_text.h"
#include "server/app/commands.h"
#include "server/app/options.h"
#include "server/app/progress_bar.h"
#include "server/control/score_json.h"
#include "server/record/run_writer.h"
#include "server/replay/export_file.h"

namespace coopdyn {

namespace {

namespace json = boost::json;

/// Simulated time divided by wall time, over the whole run.
double Factor(const RunReport& run) {
  return run.wall_s > 0 ? ToSeconds(run.status.simulated) / run.wall_s : 0;
}

bool IsCutShort(const RunReport& run) {
  const double duration_s = run.status.duration_s;
  constexpr std::array kAsMeant = {RunEnd::kDuration, RunEnd::kScore, RunEnd::kLimit, RunEnd::kClient,
                                   RunEnd::kSupervisor};
  return run.end && std::ranges::find(kAsMeant, *run.end) == kAsMeant.end() && duration_s > 0 &&
         run.frame->time_s() < duration_s;
}

std::vector<std::string> FailedControllers(const RunReport& run) {
  std::vector<std::string> robots;
  for (const auto& [robot, stopped] : run.stopped) {
    if (stopped.by == "controller") robots.push_back(robot);
  }
  return robots;
}

/// All bodies that exploded, including those before a reset or load.
std::vector<std::string> Frozen(const RunReport& run) {
  std::vector<std::string> names = run.status.frozen;
  for (const std::string& name : run.status.frozen_before) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

/// ", frozen: CRATE, swarm1_2 and 5 more"; empty without names.
std::string Named(const char* what, const std::vector<std::string>& names) {
  constexpr std::size_t kNamed = 20;
  std::string line;
  for (std::size_t i = 0; i < std::min(names.size(), kNamed); ++i) {
    line += (i == 0 ? fmt::format(", {}: ", what) : ", ") + names[i];
  }
  if (names.size() > kNamed) line += fmt::format(" and {} more", names.size() - kNamed);
  return line;
}

}  // namespace

std::map<std::string, std::string> DigestsNow(const Frame& frame) {
  RunHeader header = HeaderOf(frame, Mode::kRealtime, {}, 0);
  header.build = BuildId();
  header.libraries = LibrariesHere();
  return DigestsOf(header);
}

std::string ProgressLine(const RunReport& run) {
  const Frame& frame = *run.frame;
  const double factor = run.status.real_time_factor, duration_s = run.status.duration_s;
  const std::string of = duration_s > 0 ? fmt::format(" of {:g}", duration_s) : "";
  std::string line =
      fmt::format("t = {:.2f}{} s  step {}  real-time factor {:.2f}", frame.time_s(), of, frame.step, factor);
  if (duration_s > frame.time_s() && factor > 0) {
    line += "  " + LeftText((duration_s - frame.time_s()) / factor);
  }
  return line;
}

std::string ProgressWithBar(const RunReport& run) {
  return BarText(run.frame->time_s() / run.status.duration_s) + " " + ProgressLine(run);
}

std::string SummaryLine(const RunReport& run) {
  const Frame& frame = *run.frame;
  const std::size_t robots = frame.scene->robots.size();
  std::string line = fmt::format(
      "{} steps of {} robot{}, t = {:.2f} s in {:.2f} s, real-time factor {:.2f}, hash {}", frame.step,
      robots, robots == 1 ? "" : "s", frame.time_s(), run.wall_s, Factor(run), HashText(StateHash(frame)));
  const std::vector<std::string> frozen = Frozen(run);
  line += frozen.empty() ? ", nothing frozen" : Named("frozen", frozen);
  line += Named("controller failed", FailedControllers(run));
  if (const auto late = run.status.late_periods; late > 0)
    line += fmt::format(", {} step{} skipped", late, late == 1 ? "" : "s");
  if (const auto unsolved = run.status.unsolved; unsolved > 0)
    line += fmt::format(", {} substep{} not solved exactly", unsolved, unsolved == 1 ? "" : "s");
  if (run.recording_failed) line += ", the recording failed";
  if (IsCutShort(run)) {
    line += fmt::format(", ended early {}, at {:.2f} of {:g} s", WhyEarly(*run.end), frame.time_s(),
                        run.status.duration_s);
  }
  return line;
}

std::string SummaryJson(const RunReport& run) {
  const Frame& frame = *run.frame;
  const RunStatus& status = run.status;
  json::array frozen, stopped;
  for (const std::string& name : Frozen(run)) frozen.emplace_back(name);
  for (const auto& [robot, one] : run.stopped) {
    stopped.push_back(json::object{
        {"robot", robot}, {"by", one.by}, {"step", one.step}, {"time_s", one.time_s}, {"why", one.why}});
  }
  return JsonText(json::object{
             {"version", kVersion},
             {"cpu", CpuName()},
             {"digests", json::value_from(run.digests)},
             {"scenario", frame.scene->scenario->name},
             {"seed", frame.seed},
             {"mode", ToString(status.mode)},
             {"robots", frame.scene->robots.size()},
             {"steps", frame.step},
             {"time_s", frame.time_s()},
             {"duration_s", status.duration_s > 0 ? json::value(status.duration_s) : json::value(nullptr)},
             {"ended", run.end ? json::value(ToString(*run.end)) : json::value(nullptr)},
             {"wall_s", run.wall_s},
             {"rtf", Factor(run)},
             {"late_periods", status.late_periods},
             {"hash", HashText(StateHash(frame))},
             {"scores", ScoresJson(frame)},
             {"logged", LoggedJson(run.logged)},
             {"frozen", std::move(frozen)},
             {"unsolved", status.unsolved},
             {"stopped", std::move(stopped)},
             {"recording_failed", run.recording_failed}}) +
         "\n";
}

int ExitCode(const RunReport& run) {
  if (!Frozen(run).empty() || run.recording_failed || !FailedControllers(run).empty()) {
    return kExitFaulty;
  }
  return IsCutShort(run) ? kExitCutShort : kExitOk;
}

std::string WriteSummary(const std::string& file, const std::string& text) {
  constexpr int kMaxLinks = 40;  // the kernel's limit
  std::error_code ignored;
  if (std::filesystem::is_other(file, ignored)) {  // /dev/stdout, a pipe
    std::ofstream device(file);
    device << text;
    return device.flush() ? "" : file + " cannot be written";
  }
  std::filesystem::path target(file);  // write to the link's target, not over the link
  for (int i = 0; i < kMaxLinks && std::filesystem::is_symlink(target, ignored); ++i) {
    target = target.parent_path() / std::filesystem::read_symlink(target, ignored);
  }
  ExportFile whole(target.string());
  if (std::string error = whole.Open(true); !error.empty()) return error;
  whole.Write(text);
  return whole.Commit();
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/replay/state_at.h"
#include "server/state/controller_driver.h"

#include <spdlog/fmt/fmt.h>

#include <charconv>
#include <cmath>
#include <utility>

#include "server/replay/resimulator.h"

namespace coopdyn {

namespace {

constexpr double kMaxTime_s = 9e9;  // fits into Nanoseconds

std::string RangeOf(const std::string& file, const RunExtent& extent) {
  return fmt::format("{} has {:g} s to {:g} s (steps {} to {})", file, ToSeconds(extent.begin),
                     ToSeconds(extent.end), extent.first, extent.last);
}

/// The error for a repetition that diverges from the run.
std::string PartsAt(const RunReader& reader, std::uint64_t step, const std::string& warning) {
  std::string text = fmt::format("{}: step {} differs from the recording", reader.file(), step);
  const std::string origin = OtherOrigin(reader.header());
  if (!origin.empty()) text += "; the run was " + origin;
  if (!warning.empty()) text += "; " + warning;
  return text + ": coopdyn verify " + reader.file() + " says what differs";
}

/// Names missing controllers, without which a run cannot continue; empty if none are missing.
std::string MissingControllers(const Scene& scene) {
  std::string name;
  std::size_t robots = 0;
  const ControllerChoice& supervisor = scene.scenario->simulation.supervisor;
  if (!supervisor.empty() && supervisor.file.empty()) {
    return fmt::format(
        "{} of this run was not found: put it on the search path (--scenarios DIR, or COOPDYN_PATH)",
        SupervisorName(supervisor));
  }
  for (const SceneRobot& robot : scene.robots) {
    const ControllerChoice& controller = robot.entry.controller;
    if (controller.empty() || !controller.file.empty()) continue;
    if (robots++ == 0) name = controller.name;
  }
  if (robots == 0) return {};
  return fmt::format(
      "controller {}, which drives {} robot{} of this run, was not found: put it on the search path "
      "(--scenarios DIR, or COOPDYN_PATH)",
      name, robots, robots == 1 ? "" : "s");
}

}  // namespace

SavedStatePtr StateAt(RunReader& reader, std::uint64_t step, const ReplayServices& services,
                      std::string& error) {
  const SavedStatePtr keyframe = reader.Keyframe(step);
  if (keyframe == nullptr) {
    error = reader.error().empty()
                ? RangeOf(reader.file(), reader.extent()) + ": there is no step " + std::to_string(step)
                : reader.error();
    return nullptr;
  }
  const std::uint64_t from = keyframe->frame->step;
  const std::optional<RecordedStep> first = reader.Read(from, true);
  const std::optional<RecordedStep> wanted = reader.Read(step, true);
  if (!first || !wanted) {
    error = reader.error();
    if (error.empty()) error = fmt::format("{}: step {} was not recorded", reader.file(), step);
    return nullptr;
  }
  if (StateHash(*keyframe->frame) != first->hash) {
    error =
        fmt::format("{}: the exact state of step {} is damaged: it is not the one whose hash was recorded",
                    reader.file(), from);
    return nullptr;
  }
  error = MissingControllers(*keyframe->frame->scene);
  if (!error.empty()) return nullptr;
  const std::vector<RunInput> inputs = reader.Inputs(step, step);
  if (from == step && std::ranges::none_of(inputs, IsSupervisors)) {
    auto state = std::make_shared<SavedState>(*keyframe);
    for (const std::string& line : OtherPlugins(reader.header(), *state->frame->scene)) {
      state->warning += line + "\n";
    }
    return state;
  }

  Resimulator run(reader.file(), reader.header(), services);
  if (!run.Restore(keyframe, first->scene)) {
    error = run.error();
    return nullptr;
  }
  if (run.controllers_given_up()) {
    error = fmt::format("{}: no run can continue from step {}: {}", reader.file(), step, run.warning());
    return nullptr;
  }
  if (from < step) {
    error = run.StepTo(reader, step, [&](const RecordedStep& recorded) {
      const bool equal = StateHash(*run.frame()) == recorded.hash;
      return equal ? "" : PartsAt(reader, recorded.step, run.warning());
    });
  }
  if (!error.empty()) return nullptr;
  run.Supervise(inputs);
  auto state = std::make_shared<SavedState>(run.Save());
  state->warning = run.warning();
  return state;
}

std::optional<std::uint64_t> FindStep(RunReader& reader, const std::string& when, std::string& error) {
  const RunExtent extent = reader.extent();
  if (when == "start") return extent.first;
  if (when == "end") return extent.last;
  const std::string range = RangeOf(reader.file(), extent);
  const bool by_step = when.starts_with("#") || when.starts_with("step");
  const char* begin = when.data() + (when.starts_with("#") ? 1 : by_step ? 4 : 0);
  const char* end = when.data() + when.size();
  if (by_step) {
    std::uint64_t step = 0;
    const auto [stop, code] = std::from_chars(begin, end, step);
    if (code != std::errc() || stop != end) {
      error = "'" + when + "' is no step: write for example #1200; " + range;
      return std::nullopt;
    }
    if (step < extent.first || step > extent.last) {
      error = range + ": step " + std::to_string(step) + " is not in it";
      return std::nullopt;
    }
    std::optional<RecordedStep> read = reader.Read(step, true);
    if (read) return step;
    error = reader.error().empty() ? fmt::format("{}: step {} was not recorded", reader.file(), step)
                                   : reader.error();
    return std::nullopt;
  }
  double time_s = 0;
  const auto [stop, code] = std::from_chars(begin, end, time_s);
  const bool unit = stop + 1 == end && *stop == 's';
  if (code != std::errc() || (stop != end && !unit) || !std::isfinite(time_s)) {
    error = "'" + when + "' is no moment of a run: write simulated seconds (12.5), start, end, or a step " +
            "(#1200); " + range;
    return std::nullopt;
  }
  const bool possible = std::abs(time_s) < kMaxTime_s;
  const Nanoseconds time = possible ? std::llround(time_s * 1e9) : 0;
  if (!possible || time < extent.begin || time > extent.end) {
    error = fmt::format("{}: {:g} s is not in it", range, time_s);
    return std::nullopt;
  }
  const std::optional<std::uint64_t> step = reader.StepAt(time, false);
  if (!step) error = reader.error();
  return step;
}

}  // namespace coopdyn

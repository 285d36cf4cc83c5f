// SPDX-License-Identifier: MIT
// Two runs against each other: where they part, and by what.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "server/replay/resimulator.h"
#include "server/replay/verify.h"
#include "server/replay/verify_chain.h"
#include "server/replay/verify_difference.h"

namespace coopdyn {

namespace {

constexpr std::uint64_t kStepsAtOnce = 4096;

struct StepHash {
  std::uint64_t step = 0, hash = 0;
  std::vector<CommandRecord> commands;
};

bool SameCommands(const StepHash& one, const StepHash& other) {
  return std::equal(one.commands.begin(), one.commands.end(), other.commands.begin(), other.commands.end(),
                    [](const CommandRecord& a, const CommandRecord& b) {
                      return a.robot == b.robot && a.setpoint == b.setpoint;
                    });
}

/// The hashes of steps first…last. False if the file is damaged.
bool ReadHashes(RunReader& reader, std::uint64_t first, std::uint64_t last, std::vector<StepHash>& hashes) {
  hashes.clear();
  return reader.ForEach(first, last, true, [&](const RecordedStep& step) {
    hashes.push_back({step.step, step.hash, step.commands});
    return true;
  });
}

/// The exact frame of step `step` of a run, which need not come out as recorded. Null with `why`.
FramePtr ExactFrame(RunReader& reader, std::uint64_t step, const ReplayServices& services, std::string& why,
                    std::string& warning) {
  const SavedStatePtr keyframe = reader.Keyframe(step);
  const std::optional<RecordedStep> row =
      keyframe == nullptr ? std::nullopt : reader.Read(keyframe->frame->step, true);
  if (!row) return why = reader.error(), nullptr;
  if (keyframe->frame->step == step) return keyframe->frame;
  Resimulator run(reader.file(), reader.header(), services);
  if (!run.Restore(keyframe, row->scene)) return why = run.error(), nullptr;
  run.SetInputs(reader.Inputs(row->step, step - 1));
  std::uint64_t parted = 0;
  const bool read = reader.ForEach(row->step + 1, step, true, [&](const RecordedStep& recorded) {
    if (!run.Follows(recorded)) {
      why = reader.file() + ": steps before it were lost";
    } else if (!run.Step(recorded)) {
      why = run.error();
    } else if (parted == 0 && StateHash(*run.frame()) != recorded.hash) {
      parted = recorded.step;
    }
    return why.empty();
  });
  if (!read) why = reader.error();
  if (why.empty() && run.frame()->step != step) why = reader.file() + ": the step is not there";
  if (!why.empty()) return nullptr;
  std::string said = run.warning();
  if (parted != 0) {
    said = fmt::format("{} does not come out as recorded from step {} on: coopdyn verify {}", reader.file(),
                       parted, reader.file()) +
           (said.empty() ? "" : "\n" + said);
  }
  if (!said.empty()) warning += (warning.empty() ? "" : "\n") + said;
  return run.frame();
}

bool SameTexts(const RunHeader& one, const RunHeader& other) {
  const auto same = [](const SourceText& a, const SourceText& b) {
    return a.kind == b.kind && a.name == b.name && a.text == b.text;
  };
  return one.scenario_text == other.scenario_text &&
         std::equal(one.sources.begin(), one.sources.end(), other.sources.begin(), other.sources.end(), same);
}

std::string SpanOf(RunReader& reader) {
  const RunExtent extent = reader.extent();
  return fmt::format("{} has steps {} to {}", reader.file(), extent.first, extent.last);
}

bool Load(RunReader& reader, const ReplayServices& services, std::string& error) {
  Diagnostics diagnostics;
  if (reader.LoadScenario(services.path, diagnostics) != nullptr) return true;
  error = reader.file() + " cannot be repeated, its scenario does not load:\n" + diagnostics.ToString();
  return false;
}

/// The exact values of the first thing that differs at `at`.
VerifyReport Explain(RunReader& one, RunReader& other, const StepHash& at, const StepHash& there,
                     const ReplayServices& services, VerifyReport report) {
  const std::string scenarios = "their scenarios differ: " + one.header().scenario_name + " in " +
                                one.file() + ", " + other.header().scenario_name + " in " + other.file();
  const bool same_texts = SameTexts(one.header(), other.header());
  std::string why;
  Difference difference;
  difference.step = difference.value_step = at.step;
  difference.what = "the state";
  difference.field = "hash";
  difference.recorded = HashText(at.hash);
  difference.repeated = HashText(there.hash);
  difference.exact = true;
  FramePtr ours, theirs;
  if (Load(one, services, why) && Load(other, services, why)) {
    ours = ExactFrame(one, at.step, services, why, report.warning);
    if (ours != nullptr) theirs = ExactFrame(other, at.step, services, why, report.warning);
  }
  if (theirs != nullptr) {
    if (ours->bodies.size() != theirs->bodies.size() || ours->robots.size() != theirs->robots.size()) {
      report.error = fmt::format(
          "{} and {} are different runs from the start on: {} moving bodies and {} robots (scenario {}), {} "
          "and {} (scenario {})",
          one.file(), other.file(), ours->bodies.size(), ours->robots.size(), one.header().scenario_name,
          theirs->bodies.size(), theirs->robots.size(), other.header().scenario_name);
      return report;
    }
    difference.time = ours->time;
    if (auto found = FindExact(*ours, *theirs)) difference = std::move(*found);
  }
  if (!same_texts) report.warning += (report.warning.empty() ? "" : "\n") + scenarios;
  const std::optional<RecordedStep> mine = one.Read(at.step, true), yours = other.Read(at.step, true);
  if (mine) difference.time = mine->time;
  difference.note = why;
  for (const auto* row : {&mine, &yours}) {
    if (!*row || ours == nullptr) continue;
    const std::string commands = CommandsOf(**row, *ours->scene);
    if (commands.empty()) continue;
    difference.note +=
        (difference.note.empty() ? "" : "\n  ") + (row == &mine ? one : other).file() + ": " + commands;
  }
  difference.recorded_is = one.file();
  difference.repeated_is = other.file();
  report.difference = std::move(difference);
  return report;
}

VerifyReport CompareSteps(RunReader& one, RunReader& other, const ReplayServices& services,
                          const std::function<void(double share, std::uint64_t step)>& reached) {
  VerifyReport report;
  const RunExtent a = one.extent(), b = other.extent();
  const std::uint64_t first = std::max(a.first, b.first), last = std::min(a.last, b.last);
  if (first > last) {
    report.error = "the runs have no step in common: " + SpanOf(one) + ", " + SpanOf(other);
    return report;
  }
  std::vector<StepHash> ours, theirs;
  std::uint64_t common = 0;
  for (std::uint64_t from = first; from <= last; from += kStepsAtOnce) {
    const std::uint64_t to = std::min(last, from + kStepsAtOnce - 1);
    if (!ReadHashes(one, from, to, ours)) return report.error = one.error(), report;
    if (!ReadHashes(other, from, to, theirs)) return report.error = other.error(), report;
    auto there = theirs.begin();
    for (const StepHash& at : ours) {
      while (there != theirs.end() && there->step < at.step) ++there;
      if (there == theirs.end()) break;
      if (there->step != at.step) continue;
      if (there->hash != at.hash) return Explain(one, other, at, *there, services, std::move(report));
      if (at.step > first && report.warning.empty() && !SameCommands(at, *there)) {
        report.warning = fmt::format(
            "the hashes of step {0} are equal, but not the commands that are recorded with it: coopdyn "
            "verify {1} "
            "and coopdyn verify {2} tell which file is damaged",
            at.step, one.file(), other.file());
      }
      report.steps += at.step > first ? 1 : 0;
      ++common;
    }
    reached(static_cast<double>(to - first + 1) / static_cast<double>(last - first + 1), to);
  }
  if (common == 0) {
    report.error =
        "the runs have no step in common, as steps were lost: " + SpanOf(one) + ", " + SpanOf(other);
    return report;
  }
  if (!SameTexts(one.header(), other.header())) {
    report.warning += (report.warning.empty() ? "" : "\n") +
                      std::string("their scenarios differ, though nothing that moves does");
  }
  report.not_verified = last - first - std::min(last - first, report.steps);
  if (a.last != b.last || a.first != b.first) {
    report.warning += (report.warning.empty() ? "" : "\n") + std::string() +
                      "they are compared where both have steps, " + std::to_string(first) + " to " +
                      std::to_string(last) + ": " + SpanOf(one) + ", " + SpanOf(other);
  }
  return report;
}

}  // namespace

VerifyReport Compare(RunReader& one, RunReader& other, const ReplayServices& services,
                     const Progress& progress) {
  std::array<std::unique_ptr<ChainCheck>, 2> checks;
  for (std::size_t i = 0; i < checks.size(); ++i) {
    VerifyReport none;
    checks[i] = ChainCheck::Begin(i == 0 ? one : other, none.error);
    if (checks[i] == nullptr) return none;
  }
  VerifyReport report =
      CompareSteps(one, other, services, [&checks, &progress](double share, std::uint64_t step) {
        for (const auto& check : checks) check->GoTo(step);
        if (progress) progress(share);
      });
  std::string damage;
  for (const auto& check : checks) {
    const std::string found = check->Finish();
    damage += (damage.empty() || found.empty() ? "" : "\n") + found;
  }
  if (damage.empty()) return report;
  if (report.error.empty() && !report.difference) {
    report.error = damage + "\napart from that, " + StepsAre(report.steps) + " equal";
  } else {
    report.warning += (report.warning.empty() ? "" : "\n") + damage;
  }
  return report;
}

}  // namespace coopdyn

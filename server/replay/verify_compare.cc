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
#include "server/replay/verify_inputs.h"

namespace coopdyn {

namespace {

constexpr std::uint64_t kStepsAtOnce = 4096;

struct StepHash {
  std::uint64_t step = 0, hash = 0;
  std::vector<CommandRecord> commands;
};

void Warn(const std::string& line, VerifyReport& report) {
  report.warning += (report.warning.empty() ? "" : "\n") + line;
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
  if (why = reader.error(); !why.empty()) return nullptr;
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

/// The exact values of the first thing that differs at `at`; both runs are there from step `first` on.
VerifyReport Explain(RunReader& one, RunReader& other, std::uint64_t first, const StepHash& at,
                     const StepHash& there, const ReplayServices& services, VerifyReport report) {
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
    if (ours->bodies.size() != theirs->bodies.size() || ours->channels.size() != theirs->channels.size() ||
        ours->scene->robots.size() != theirs->scene->robots.size() ||
        ours->channels.size() != theirs->channels.size()) {
      report.error = fmt::format(
          "{} and {} are different runs from the start on: {} moving bodies and {} robots (scenario {}), {} "
          "and {} (scenario {})",
          one.file(), other.file(), ours->bodies.size(), ours->scene->robots.size(),
          one.header().scenario_name, theirs->bodies.size(), theirs->scene->robots.size(),
          other.header().scenario_name);
      return report;
    }
    difference.time = ours->time;
    if (auto found = FindExact(*ours, *theirs)) difference = std::move(*found);
  }
  if (auto length = FindStepLength(one, other, at.step)) difference = std::move(*length);
  if (!same_texts) Warn(scenarios, report);
  const std::optional<RecordedStep> mine = one.Read(at.step, true), yours = other.Read(at.step, true);
  if (mine) difference.time = mine->time;
  difference.note = why;
  const auto note = [&difference](const std::string& line) {
    if (!line.empty()) difference.note += (difference.note.empty() ? "" : "\n  ") + line;
  };
  if (at.step > first) note(InputsThatDiffer(one, other, first, at.step - 1));
  for (const auto* row : {&mine, &yours}) {
    if (!*row || ours == nullptr) continue;
    const std::string commands = CommandsOf(**row, *ours->scene);
    if (!commands.empty()) note((row == &mine ? one : other).file() + ": " + commands);
  }
  difference.recorded_is = one.file();
  difference.repeated_is = other.file();
  report.difference = std::move(difference);
  return report;
}

VerifyReport CompareSteps(RunReader& one, RunReader& other, const ReplayServices& services,
                          CommandCompare& commands,
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
      if (there->hash != at.hash) return Explain(one, other, first, at, *there, services, std::move(report));
      if (at.step > first) commands.Look(at.step, at.commands, there->commands);
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
    Warn("their scenarios differ, though nothing that moves does", report);
  }
  report.not_verified = last - first - std::min(last - first, report.steps);
  if (a.last != b.last || a.first != b.first) {
    Warn(fmt::format("they are compared where both have steps, {} to {}: {}, {}", first, last, SpanOf(one),
                     SpanOf(other)),
         report);
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
  CommandCompare commands(one, other);
  VerifyReport report =
      CompareSteps(one, other, services, commands, [&checks, &progress](double share, std::uint64_t step) {
        for (const auto& check : checks) check->GoTo(step);
        if (progress) progress(share);
      });
  std::string damage;
  for (const auto& check : checks) {
    const std::string found = check->Finish();
    damage += (damage.empty() || found.empty() ? "" : "\n") + found;
  }
  const bool equal = report.error.empty() && !report.difference;
  if (damage.empty()) {
    // Only now is it known that what is recorded of commands is what came.
    if (const std::string said = commands.ToString(); equal && !said.empty()) Warn(said, report);
    return report;
  }
  if (equal) {
    report.error = damage + "\napart from that, " + StepsAre(report.steps) + " equal";
  } else {
    Warn(damage, report);
  }
  return report;
}

}  // namespace coopdyn

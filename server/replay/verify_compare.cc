// SPDX-License-Identifier: MIT
// Compares two runs: where they diverge, and the first difference.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
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

/// Commands of `one` to channels that `other` does not command.
std::vector<CommandRecord> OnlyIn(const std::vector<CommandRecord>& one,
                                  const std::vector<CommandRecord>& other) {
  std::vector<CommandRecord> only;
  std::set_difference(one.begin(), one.end(), other.begin(), other.end(), std::back_inserter(only),
                      [](const CommandRecord& a, const CommandRecord& b) { return a.channel < b.channel; });
  return only;
}

/// The simulated length of step `step`, if it and the step before are recorded.
std::optional<Nanoseconds> StepLength(RunReader& reader, std::uint64_t step) {
  if (step <= reader.extent().first) return std::nullopt;
  const auto before = reader.Read(step - 1, true), at = reader.Read(step, true);
  return before && at ? std::optional(at->time - before->time) : std::nullopt;
}

/// Inputs that decide when a step runs, not its result.
bool IsPace(const RunInput& input) {
  return std::holds_alternative<RunEdit>(input.what) && As<edit::SetStep>(input.what) == nullptr &&
         As<edit::StopAll>(input.what) == nullptr && As<edit::UnloadController>(input.what) == nullptr &&
         As<edit::TuneJoints>(input.what) == nullptr;
}

std::vector<RunInput> InputsOf(RunReader& reader, std::uint64_t first, std::uint64_t last) {
  std::vector<RunInput> inputs = reader.Inputs(first, last);
  std::erase_if(inputs, IsPace);
  return inputs;
}

/// "set_step 0.02 after step 30".
std::string Worded(const RunInput* input) {
  if (input == nullptr) return "none";
  const InputText text = Encode(*input);
  return fmt::format("{}{}{} after step {}", text.action, text.detail.empty() ? "" : " ", text.detail,
                     input->step);
}

/// Compares the commands of steps that are equal in both recordings.
class CommandCompare {
 public:
  CommandCompare(RunReader& one, RunReader& other) : runs_{&one, &other} {}
  /// Both by increasing channel.
  void Look(std::uint64_t step, const std::vector<CommandRecord>& one,
            const std::vector<CommandRecord>& other);
  /// Commands found in only one run, provided that nothing is damaged; lines, or empty.
  std::string ToString() const;

 private:
  std::array<const RunReader*, 2> runs_;
  const RunReader* only_ = nullptr;   // the only run with commands of controllers
  const RunReader* again_ = nullptr;  // the first run with commands that were already in force
  std::uint64_t again_step_ = 0;      // the step of again_
};

void CommandCompare::Look(std::uint64_t step, const std::vector<CommandRecord>& one,
                          const std::vector<CommandRecord>& other) {
  if (only_ != nullptr && again_ != nullptr) return;
  for (const bool swapped : {false, true}) {
    const RunReader *has = runs_[swapped ? 1 : 0], *lacks = runs_[swapped ? 0 : 1];
    for (const CommandRecord& command : swapped ? OnlyIn(other, one) : OnlyIn(one, other)) {
      if (!command.by_client && !lacks->header().what.controllers) {
        only_ = has;
      } else if (again_ == nullptr) {
        again_ = has;
        again_step_ = step;
      }
    }
  }
}

std::string CommandCompare::ToString() const {
  std::string text;
  if (only_ != nullptr) {
    text = fmt::format("the commands of controllers are recorded in {} only", only_->file());
  }
  if (again_ != nullptr) {
    text += fmt::format(
        "{}the runs are equal, but their commands differ: from step {} on {} also has commands that repeat "
        "those in force",
        text.empty() ? "" : "\n", again_step_, again_->file());
  }
  return text;
}

/// The difference in length of step `step`, if any.
std::optional<Difference> FindStepLength(RunReader& one, RunReader& other, std::uint64_t step) {
  const std::optional<Nanoseconds> ours = StepLength(one, step), theirs = StepLength(other, step);
  if (!ours || !theirs || *ours == *theirs) return std::nullopt;
  return Difference{step,
                    0,
                    "the step",
                    "length_s",
                    fmt::format("{}", ToSeconds(*ours)),
                    fmt::format("{}", ToSeconds(*theirs))};
}

/// The first input after steps first…last that affects a step's result and is not in both recordings; empty
/// if none.
std::string InputsThatDiffer(RunReader& one, RunReader& other, std::uint64_t first, std::uint64_t last) {
  const std::vector<RunInput> ours = InputsOf(one, first, last), theirs = InputsOf(other, first, last);
  const auto [a, b] = std::mismatch(
      ours.begin(), ours.end(), theirs.begin(), theirs.end(),
      [](const RunInput& x, const RunInput& y) { return x.step == y.step && Encode(x) == Encode(y); });
  const RunInput* mine = a == ours.end() ? nullptr : &*a;
  const RunInput* yours = b == theirs.end() ? nullptr : &*b;
  if (mine == nullptr && yours == nullptr) return {};
  // If the inputs follow different steps, the earlier one is missing in the other run.
  if (mine != nullptr && yours != nullptr && mine->step != yours->step) {
    (mine->step < yours->step ? yours : mine) = nullptr;
  }
  return fmt::format("the first input that differs: {} {}, {} {}", one.file(), Worded(mine), other.file(),
                     Worded(yours));
}

/// The hashes of steps first…last. False if the file is damaged.
bool ReadHashes(RunReader& reader, std::uint64_t first, std::uint64_t last, std::vector<StepHash>& hashes) {
  hashes.clear();
  return reader.ForEach(first, last, true, [&](const RecordedStep& step) {
    hashes.push_back({step.step, step.hash, step.commands});
    return true;
  });
}

/// The exact frame of step `step` of a run, which may differ from the recording. Null with `why` on failure.
FramePtr ExactFrame(RunReader& reader, std::uint64_t step, const ReplayServices& services, std::string& why,
                    std::string& warning) {
  const SavedStatePtr keyframe = reader.Keyframe(step);
  const std::optional<RecordedStep> row =
      keyframe == nullptr ? std::nullopt : reader.Read(keyframe->frame->step, true);
  if (!row) return why = reader.error(), nullptr;
  if (keyframe->frame->step == step) return keyframe->frame;
  Resimulator run(reader.file(), reader.header(), services);
  if (!run.Restore(keyframe, row->scene)) return why = run.error(), nullptr;
  std::uint64_t parted = 0;
  why = run.StepTo(reader, step, [&](const RecordedStep& recorded) -> std::string {
    if (parted == 0 && StateHash(*run.frame()) != recorded.hash) parted = recorded.step;
    return {};
  });
  if (!why.empty()) return nullptr;
  std::string said = run.warning();
  if (parted != 0) {
    said = fmt::format("{} differs from its recording from step {} on: coopdyn verify {}", reader.file(),
                       parted, reader.file()) +
           (said.empty() ? "" : "\n" + said);
  }
  AddLine(said, warning);
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

/// `line` prefixed with the file of `reader`; empty stays empty.
std::string Of(const RunReader& reader, const std::string& line) {
  return line.empty() ? line : reader.file() + ": " + line;
}

bool Load(RunReader& reader, const ReplayServices& services, std::string& error) {
  Diagnostics diagnostics;
  if (reader.LoadScenario(services.path, diagnostics) != nullptr) return true;
  error = CannotLoadText(reader, diagnostics);
  return false;
}

/// Finds the exact values of the first difference at step `at`; both runs have steps from `first` on.
VerifyReport Explain(RunReader& one, RunReader& other, std::uint64_t first, const StepHash& at,
                     const StepHash& there, const ReplayServices& services, VerifyReport report) {
  const std::string scenarios = "their scenarios differ: " + one.header().scenario_name + " in " +
                                one.file() + ", " + other.header().scenario_name + " in " + other.file();
  const bool same_texts = SameTexts(one.header(), other.header());
  std::string why;
  Difference difference{at.step, 0, "the state", "hash", HashText(at.hash), HashText(there.hash)};
  FramePtr ours, theirs;
  if (Load(one, services, why) && Load(other, services, why)) {
    ours = ExactFrame(one, at.step, services, why, report.warning);
    if (ours != nullptr) theirs = ExactFrame(other, at.step, services, why, report.warning);
  }
  if (theirs != nullptr) {
    if (!CanCompare(*ours, *theirs)) {
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
  if (!same_texts) AddLine(scenarios, report.warning);
  const std::optional<RecordedStep> mine = one.Read(at.step, true), yours = other.Read(at.step, true);
  if (mine) difference.time = mine->time;
  difference.note = why;
  const auto note = [&difference](const std::string& line) {
    if (!line.empty()) difference.note += (difference.note.empty() ? "" : "\n  ") + line;
  };
  if (at.step > first) note(InputsThatDiffer(one, other, first, at.step - 1));
  if (mine && ours != nullptr) note(Of(one, CommandsOf(*mine, *ours->scene)));
  if (yours && theirs != nullptr) note(Of(other, CommandsOf(*yours, *theirs->scene)));
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
    AddLine("their scenarios differ, but all motion is equal", report.warning);
  }
  report.not_verified = last - first - std::min(last - first, report.steps);
  if (a.last != b.last || a.first != b.first) {
    AddLine(fmt::format("they are compared where both have steps, {} to {}: {}, {}", first, last, SpanOf(one),
                        SpanOf(other)),
            report.warning);
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
    AddLine(check->Finish(), damage);
  }
  const bool equal = report.error.empty() && !report.difference;
  if (damage.empty()) {
    // Only now is it known that the recorded commands are undamaged.
    if (equal) AddLine(commands.ToString(), report.warning);
    return report;
  }
  if (equal) {
    report.error = damage + "\napart from that, " + StepsAre(report.steps) + " equal";
  } else {
    AddLine(damage, report.warning);
  }
  return report;
}

}  // namespace coopdyn

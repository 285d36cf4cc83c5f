// SPDX-License-Identifier: MIT
#include "server/replay/verify_inputs.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <iterator>

namespace coopdyn {

namespace {

/// Commands of `one` to channels that `other` does not command.
std::vector<CommandRecord> OnlyIn(const std::vector<CommandRecord>& one,
                                  const std::vector<CommandRecord>& other) {
  std::vector<CommandRecord> only;
  std::set_difference(one.begin(), one.end(), other.begin(), other.end(), std::back_inserter(only),
                      [](const CommandRecord& a, const CommandRecord& b) { return a.channel < b.channel; });
  return only;
}

/// How long step `step` took, if it and the one before it are there.
std::optional<Nanoseconds> StepLength(RunReader& reader, std::uint64_t step) {
  if (step <= reader.extent().first) return std::nullopt;
  const auto before = reader.Read(step - 1, true), at = reader.Read(step, true);
  return before && at ? std::optional(at->time - before->time) : std::nullopt;
}

/// Such decide when a step runs, not what it gives.
bool IsPace(const RunInput& input) {
  return std::holds_alternative<RunEdit>(input.what) && As<edit::SetStep>(input.what) == nullptr &&
         As<edit::StopAll>(input.what) == nullptr && As<edit::UnloadController>(input.what) == nullptr;
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

}  // namespace

void CommandCompare::Look(std::uint64_t step, const std::vector<CommandRecord>& one,
                          const std::vector<CommandRecord>& other) {
  if (only_ != nullptr && again_) return;
  for (const bool swapped : {false, true}) {
    const RunReader *has = runs_[swapped ? 1 : 0], *lacks = runs_[swapped ? 0 : 1];
    for (const CommandRecord& command : swapped ? OnlyIn(other, one) : OnlyIn(one, other)) {
      if (!command.by_client && !lacks->header().what.controllers) {
        only_ = has;
      } else if (!again_) {
        again_ = Again{has, step};
      }
    }
  }
}

std::string CommandCompare::ToString() const {
  std::string text;
  if (only_ != nullptr) {
    text = fmt::format("the commands of controllers are recorded in {} only", only_->file());
  }
  if (again_) {
    text += fmt::format(
        "{}the runs are equal, but not what was commanded: from step {} on {} was sent commands again that "
        "were in force already",
        text.empty() ? "" : "\n", again_->step, again_->run->file());
  }
  return text;
}

std::optional<Difference> FindStepLength(RunReader& one, RunReader& other, std::uint64_t step) {
  const std::optional<Nanoseconds> ours = StepLength(one, step), theirs = StepLength(other, step);
  if (!ours || !theirs || *ours == *theirs) return std::nullopt;
  Difference difference;
  difference.step = difference.value_step = step;
  difference.what = "the step";
  difference.field = "length_s";
  difference.recorded = fmt::format("{}", ToSeconds(*ours));
  difference.repeated = fmt::format("{}", ToSeconds(*theirs));
  difference.exact = true;
  return difference;
}

std::string InputsThatDiffer(RunReader& one, RunReader& other, std::uint64_t first, std::uint64_t last) {
  const std::vector<RunInput> ours = InputsOf(one, first, last), theirs = InputsOf(other, first, last);
  const auto [a, b] = std::mismatch(
      ours.begin(), ours.end(), theirs.begin(), theirs.end(),
      [](const RunInput& x, const RunInput& y) { return x.step == y.step && Encode(x) == Encode(y); });
  const RunInput* mine = a == ours.end() ? nullptr : &*a;
  const RunInput* yours = b == theirs.end() ? nullptr : &*b;
  if (mine == nullptr && yours == nullptr) return {};
  // Of two that came after other steps the first one: the other run lacks it.
  if (mine != nullptr && yours != nullptr && mine->step != yours->step) {
    (mine->step < yours->step ? yours : mine) = nullptr;
  }
  return fmt::format("the first input that differs: {} {}, {} {}", one.file(), Worded(mine), other.file(),
                     Worded(yours));
}

}  // namespace coopdyn

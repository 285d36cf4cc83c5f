// SPDX-License-Identifier: MIT
#include "server/replay/verify.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "server/replay/resimulator.h"
#include "server/replay/verify_chain.h"
#include "server/replay/verify_difference.h"

namespace coopdyn {

namespace {

/// How many steps to follow a difference when there is no later exact state.
constexpr std::uint64_t kMaxFollowed = 2000;
constexpr std::uint64_t kTellEvery = 16;

/// Repeats a recording once, from keyframe to keyframe.
class Verifier {
 public:
  Verifier(RunReader& reader, const ReplayServices& services, const Progress& progress)
      : reader_(reader), progress_(progress), run_(reader.file(), reader.header(), services) {}

  VerifyReport Verify() {
    extent_ = reader_.extent();
    if (Begin()) {
      std::size_t next = 1;
      for (std::uint64_t from = extent_.first; from < extent_.last;) {
        while (next < keyframes_.size() && keyframes_[next] <= from) ++next;
        const bool keyframe = next < keyframes_.size() && keyframes_[next] <= extent_.last;
        const std::uint64_t to = keyframe ? keyframes_[next] : extent_.last;
        if (!Segment(from, to, keyframe)) break;
        from = to;
      }
    }
    if (progress_) progress_(1);
    Conclude();
    const std::string origin = report_.difference ? OtherOrigin(reader_.header()) : "";
    report_.warning = origin.empty() ? "" : reader_.file() + " was " + origin;
    AddLine(run_.warning(), report_.warning);
    if (!head_.empty() && !head_said_) AddLine(reader_.file() + ": " + head_, report_.warning);
    return std::move(report_);
  }

 private:
  /// Returns false, with `report_` filled in.
  bool Fail(std::string error) {
    report_.error = error.empty() ? reader_.file() + " cannot be read" : std::move(error);
    return false;
  }
  bool Differs(Difference difference) {
    report_.difference = std::move(difference);
    return false;
  }

  /// Reports a row that was changed after it was written.
  bool Differs(const ChainDamage& damage) { return Differs(DifferenceOf(damage, reader_)); }

  /// Reports findings that are known only at the end.
  void Conclude() {
    const bool equal = report_.error.empty() && !report_.difference && !changed_;
    if (equal && !reader_.growing() && extent_.missing > 0) {
      Fail(
          fmt::format("{}: {} missing at its end: it is damaged", reader_.file(), StepsAre(extent_.missing)));
    } else if (equal && !reader_.growing() && report_.not_verified > extent_.lost) {
      Fail(fmt::format("{}: {} not to be verified, from step {} on, where it calls {} lost: it is damaged",
                       reader_.file(), StepsAre(report_.not_verified), first_not_verified_, extent_.lost));
    }
    if (chain_ == nullptr || !report_.error.empty()) return;
    if (changed_) return TellChanged(*changed_);
    if (report_.difference) return;
    std::string ends;
    if (const std::optional<ChainDamage> damage = chain_->CheckRest(ends)) {
      Differs(*damage);
    } else if (!chain_->error().empty()) {
      Fail(chain_->error());
    } else if (!ends.empty() || !head_.empty()) {
      head_said_ = ends.empty();
      Fail(fmt::format("{}: {}: it is damaged", reader_.file(), head_said_ ? head_ : ends));
    }
  }
  void TellChanged(const ChainDamage& damage) {
    if (!report_.difference || report_.difference->step > damage.step + 1) {
      report_.steps = std::min(report_.steps, steps_unchanged_);
      Differs(damage);
      return;
    }
    std::string& note = report_.difference->note;
    note += fmt::format("{}{} is not as it was written", note.empty() ? "" : "; ", damage.what);
  }

  /// Restores the first frame and compares it with its recorded row.
  bool Begin() {
    std::string error;
    chain_ = RunChain::Open(reader_.file(), error);
    if (chain_ == nullptr) return Fail(error);
    head_ = chain_->CheckHead();
    if (!chain_->error().empty()) return Fail(chain_->error());
    keyframes_ = reader_.Keyframes();
    if (!reader_.error().empty()) return Fail(reader_.error());
    return Resume(extent_.first) && CheckRows(extent_.first, 0);
  }

  /// Continues from the keyframe of `step`.
  bool Resume(std::uint64_t step) {
    const SavedStatePtr state = reader_.Keyframe(step);
    if (state == nullptr) return Fail(reader_.error());
    if (state->frame->step != step) {
      return Fail(fmt::format("{}: the exact state of step {} is missing: it cannot be repeated",
                              reader_.file(), step));
    }
    const std::optional<RecordedStep> row = reader_.Read(step, true);
    if (!row) return Fail(reader_.error());
    if (!run_.Restore(state, row->scene)) return Fail(run_.error());
    lost_track_ = false;
    const Frame& frame = *run_.frame();
    if (StateHash(frame) != row->hash) {
      failed_ = *row;
      return Differs(Locate(0, false));
    }
    std::vector<Setpoint> recorded(run_.recorded_setpoints().begin(), run_.recorded_setpoints().end());
    for (const CommandRecord& command : row->commands) {
      if (command.channel >= recorded.size()) {
        return Fail(fmt::format("{}: step {} is damaged: it commands a joint that is not there",
                                reader_.file(), step));
      }
      recorded[command.channel] = command.setpoint;
    }
    std::optional<Difference> difference = FindSetpoint(recorded, frame);
    if (!difference) return CheckKeyframeRows(step, report_.steps);
    difference->note = "the exact state of this step has the other value, and its hash is equal";
    return Differs(std::move(*difference));
  }

  /// Checks the steps `from` + 1 to `to`; `keyframe`: there is an exact state of `to`.
  bool Segment(std::uint64_t from, std::uint64_t to, bool keyframe) {
    run_.SetInputs(reader_.Inputs(from, to - 1));
    if (!reader_.error().empty()) return Fail(reader_.error());
    bool stopped = false;
    const bool read = reader_.ForEach(from + 1, to, false, [&](const RecordedStep& step) {
      stopped = !Check(step);
      return !stopped;
    });
    if (!read) return Fail(reader_.error());
    if (failed_) return Differs(Locate(to, keyframe));
    if (stopped) return false;
    const std::uint64_t reached = run_.frame()->step;
    if (reached == to) return !keyframe || CheckKeyframe(to);
    lost_track_ = true;
    if (report_.not_verified == 0) first_not_verified_ = reached + 1;
    if (!keyframe) {
      report_.not_verified += to - reached;
      return true;
    }
    report_.not_verified += to - reached - 1;
    if (!Resume(to)) return false;
    ++report_.steps;
    return true;
  }

  /// Runs and checks `step`. False if it differs (sets `failed_` if its hash does) or is impossible.
  bool Check(const RecordedStep& step) {
    if (lost_track_ || !run_.Follows(step)) {
      lost_track_ = true;
      return changed_ || CheckRows(step.step, report_.steps);
    }
    if (std::optional<Difference> difference = FindImpossible(step)) return Differs(std::move(*difference));
    if (!run_.Step(step)) return Fail(run_.error());
    const Frame& frame = *run_.frame();
    if (StateHash(frame) != step.hash) {
      failed_ = step;
      return false;
    }
    if (std::optional<Difference> difference = FindInRecord(step)) {
      difference->note = "the state is the recorded one: what is recorded of this controller is damaged";
      return Differs(std::move(*difference));
    }
    if (std::optional<Difference> difference = FindInRow(step, frame)) {
      difference->note = "the state is as recorded: the recorded poses or readings of this step are damaged";
      return Differs(std::move(*difference));
    }
    if (changed_) return false;  // but the repetition shows no difference
    if (!CheckRows(step.step, report_.steps++)) return false;
    const std::uint64_t done = step.step - extent_.first;
    if (progress_ && done % kTellEvery == 0) {
      progress_(static_cast<double>(done) / static_cast<double>(extent_.last - extent_.first));
    }
    return true;
  }

  /// After the repetition equals the run up to `step`, checks whether the rows were changed. A changed
  /// broadcast or input may show as a more telling difference in the next step, so changed_ is kept until
  /// then.
  bool CheckRows(std::uint64_t step, std::uint64_t steps_before) {
    changed_ = chain_->CheckRows(step);
    steps_unchanged_ = steps_before;
    return chain_->error().empty() || Fail(chain_->error());
  }
  bool CheckKeyframeRows(std::uint64_t step, std::uint64_t steps_before) {
    const std::optional<ChainDamage> damage = chain_->CheckKeyframes(step);
    if (!chain_->error().empty()) return Fail(chain_->error());
    if (!damage || changed_) return true;
    changed_ = damage;
    steps_unchanged_ = steps_before;
    return false;
  }

  /// Finds a command that no recorder writes: for a part of an actuator, without a sender and without effect,
  /// or from a client for a robot that a controller drives.
  std::optional<Difference> FindImpossible(const RecordedStep& step) const {
    if (run_.BeginsScene(step)) return std::nullopt;  // the first row of a scene has all commands
    const Scene& scene = *run_.frame()->scene;
    const std::span<const Setpoint> in_force = run_.recorded_setpoints();
    for (auto next = step.commands.begin(); next != step.commands.end();) {
      if (next->channel >= in_force.size()) return std::nullopt;  // Step() reports it
      const CommandRecord& first = *next;
      const SceneActuator& actuator = scene.actuators[ActuatorOf(scene, first.channel)];
      bool changes = false, whole = first.channel == static_cast<std::uint32_t>(actuator.first_channel);
      for (int i = 0; i < actuator.channel_count && whole; ++i, ++next) {
        whole = next != step.commands.end() && next->by_client == first.by_client &&
                next->channel == first.channel + static_cast<std::uint32_t>(i);
        if (!whole) break;
        changes |= !SameBits(next->setpoint, in_force[next->channel]);
      }
      const bool driven = run_.computes(first.channel);
      const bool idle = !first.by_client && !driven && !changes;
      if (whole && !idle && !(driven && first.by_client)) continue;
      const auto robot = static_cast<std::size_t>(actuator.robot);
      Difference difference{
          step.step,
          step.time,
          scene.robots[robot].entry.name,
          "command",
          !whole ? "a part of one"
          : idle ? "of nobody, without effect"
                 : "of a client",
          !whole || idle ? "such a command is not recorded" : "a loaded controller drives it"};
      difference.note = "what is recorded of this command is damaged";
      return difference;
    }
    return std::nullopt;
  }

  /// Compares the set-points of loaded controllers.
  std::optional<Difference> FindComputed(const Frame& frame) const {
    return FindSetpoint(run_.recorded_setpoints(), frame,
                        [this](std::size_t channel) { return run_.computes(channel); });
  }

  /// Compares the recorded actions of loaded controllers with the repeated ones.
  std::optional<Difference> FindInRecord(const RecordedStep& step) const {
    if (!run_.has_controllers()) return std::nullopt;
    const Frame& frame = *run_.frame();
    if (reader_.header().what.controllers) {
      if (auto found = FindComputed(frame)) return found;
    }
    return FindMessage(step.messages, frame);
  }

  bool CheckKeyframe(std::uint64_t step) {
    const SavedStatePtr state = reader_.Keyframe(step);
    if (state == nullptr) return Fail(reader_.error());
    std::optional<Difference> difference = FindExact(*state->frame, *run_.frame());
    if (!difference && run_.has_controllers()) difference = FindSaved(state->controllers);
    if (!difference) return CheckKeyframeRows(step, report_.steps - 1);
    difference->note = "the hash of this step is equal: its exact state in the file is damaged";
    --report_.steps;
    return Differs(std::move(*difference));
  }

  std::optional<Difference> FindSaved(std::span<const std::byte> recorded) const {
    const std::vector<std::byte> repeated = run_.Save().controllers;
    const auto [a, b] = std::mismatch(recorded.begin(), recorded.end(), repeated.begin(), repeated.end());
    if (a == recorded.end() && b == repeated.end()) return std::nullopt;
    const auto worded = [](auto at, auto end, std::size_t place) {
      return at == end ? fmt::format("ends after {} bytes", place)
                       : fmt::format("byte {} is {}", place, std::to_integer<int>(*at));
    };
    const auto place = static_cast<std::size_t>(a - recorded.begin());
    return DifferenceAt(*run_.frame(), "loaded controllers", "saved_state", worded(a, recorded.end(), place),
                        worded(b, repeated.end(), place));
  }

  /// Locates the difference in `failed_`, the step of frame() whose hash differs; searches up to step `to`.
  Difference Locate(std::uint64_t to, bool keyframe) {
    const RecordedStep failed = std::move(*failed_);
    failed_.reset();
    const Frame& frame = *run_.frame();
    std::string note = CommandsOf(failed, *frame.scene);
    Difference nothing =
        DifferenceAt(frame, "the state", "hash", HashText(failed.hash), HashText(StateHash(frame)));
    std::optional<Difference> found = FindVisible(failed.step);
    if (!found && to > failed.step) found = Follow(failed.step, to, keyframe, note);
    Difference difference = found ? std::move(*found) : std::move(nothing);
    difference.step = failed.step;
    difference.time = failed.time;
    difference.note = std::move(note);
    return difference;
  }

  /// Finds a difference visible in the current step: set-points of controllers, poses.
  std::optional<Difference> FindVisible(std::uint64_t step) {
    const Frame& frame = *run_.frame();
    if (run_.has_controllers() && reader_.header().what.controllers) {
      if (auto found = FindComputed(frame)) return found;
    }
    const std::optional<RecordedStep> row = reader_.Read(step);
    return row ? FindPose(row->bodies, frame) : std::nullopt;
  }

  /// Repeats steps after `from`: up to the exact state of `to` if there is one, else until the difference
  /// shows.
  std::optional<Difference> Follow(std::uint64_t from, std::uint64_t to, bool keyframe, std::string& note) {
    std::optional<Difference> visible;
    bool equal_again = false, broken = false;
    const std::uint64_t last = keyframe ? to : std::min(to, from + kMaxFollowed);
    reader_.ForEach(from + 1, last, false, [&](const RecordedStep& step) {
      broken = !run_.Follows(step) || !run_.Step(step);
      if (broken) return false;
      const Frame& frame = *run_.frame();
      equal_again = StateHash(frame) == step.hash;
      if (equal_again) return false;
      if (!visible) visible = FindPose(step.bodies, frame);
      return keyframe || !visible;
    });
    if (equal_again) {
      note += fmt::format("{}step {} is equal again: a set-point that had no effect is damaged, or this hash",
                          note.empty() ? "" : "; ", run_.frame()->step);
      return std::nullopt;
    }
    if (keyframe && !broken && run_.frame()->step == to) {
      const SavedStatePtr state = reader_.Keyframe(to);
      if (state != nullptr && state->frame->step == to) {
        if (auto exact = FindExact(*state->frame, *run_.frame())) return exact;
      }
    }
    return visible;
  }

  RunReader& reader_;
  const Progress& progress_;
  Resimulator run_;
  RunExtent extent_;
  std::unique_ptr<RunChain> chain_;
  std::string head_;                    // the change of table meta or the texts; or empty
  bool head_said_ = false;              // head_ is in report_.error
  std::optional<ChainDamage> changed_;  // the first changed row
  std::uint64_t steps_unchanged_ = 0;   // report_.steps before changed_
  std::vector<std::uint64_t> keyframes_;
  std::optional<RecordedStep> failed_;  // the step whose hash differs from frame()
  bool lost_track_ = false;             // until the next keyframe
  std::uint64_t first_not_verified_ = 0;
  VerifyReport report_;
};

}  // namespace

VerifyReport Verify(RunReader& reader, const ReplayServices& services, const Progress& progress) {
  Diagnostics diagnostics;
  if (reader.LoadScenario(services.path, diagnostics) == nullptr) {
    VerifyReport report;
    report.error = CannotLoadText(reader, diagnostics);
    std::string none;
    const auto chain = RunChain::Open(reader.file(), none);
    const std::string head = chain == nullptr ? "" : chain->CheckHead();
    if (!head.empty()) report.warning = reader.file() + ": " + head;
    return report;
  }
  return Verifier(reader, services, progress).Verify();
}

}  // namespace coopdyn

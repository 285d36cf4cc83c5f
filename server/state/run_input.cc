// SPDX-License-Identifier: MIT
#include "server/state/run_input.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "protocol/codec.h"
#include "protocol/command_ids.h"
#include "protocol/module_tables.h"
#include "server/base/clock.h"
#include "server/model/values.h"
#include "server/state/change_codec.h"
#include "server/state/joint_tuning.h"

namespace coopdyn {

namespace {

constexpr std::string_view kDeadline = "deadline", kDisconnect = "disconnect",
                           kStopped = "controller_stopped", kSupervisorStopped = "supervisor_stopped",
                           kEdit = "edit";

const CommandTable& Commands() {
  static const CommandTable table = SimulationTable();
  return table;
}

/// The commands of control boards.
const CommandTable& Boards() {
  static const CommandTable table = JointsTable();
  return table;
}

/// The word for a command of /simulation.
std::string Word(command::Id id) {
  return Commands().Find(id)->name;
}

std::string Number(double value) {
  std::string text;
  AppendDouble(value, text);
  return text;
}

std::string Joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

struct TextOf {
  InputText operator()(const edit::Run&) const { return {Word(command::kRun), ""}; }
  InputText operator()(const edit::Pause&) const { return {Word(command::kPause), ""}; }
  InputText operator()(const edit::Step& step) const {
    return {Word(command::kStep), std::to_string(step.steps)};
  }
  InputText operator()(const edit::SetMode& set) const {
    return {Word(command::kSetMode), ToString(set.mode)};
  }
  InputText operator()(const edit::SetStep& set) const {
    return {Word(command::kSetStep), Number(ToSeconds(set.step))};
  }
  InputText operator()(const edit::SetSpeed& set) const {
    return {Word(command::kSetSpeed), Number(set.factor)};
  }
  InputText operator()(const edit::SetParticipants& set) const {
    return {Word(command::kSetParticipants), Joined(set.names)};
  }
  InputText operator()(const edit::StopAll&) const { return {Word(command::kStopAll), ""}; }
  InputText operator()(const edit::TuneJoints& tuning) const {
    std::string text = "/" + tuning.robot + "/" + tuning.module;
    for (std::size_t i = 0; i < tuning.joints.size(); ++i) {
      text += (i == 0 ? " (" : " ") + std::to_string(tuning.joints[i]);
    }
    if (!tuning.joints.empty()) text += ")";
    for (const double value : tuning.values) text += " " + Number(value);
    return {Boards().Find(tuning.command)->name, std::move(text)};
  }
  InputText operator()(const edit::UnloadController& unload) const {
    return {Word(command::kReleaseRobot), unload.robot};
  }
  InputText operator()(const WorldChange& change) const {
    return {std::string(kEdit), change.label + "\n" + EncodeChange(change)};
  }
  InputText operator()(const DeadlineFired& fired) const {
    return {std::string(kDeadline), fired.robot + " " + ToString(fired.policy)};
  }
  InputText operator()(const ClientLost& lost) const {
    return {std::string(kDisconnect), lost.robot + " " + ToString(lost.policy)};
  }
  InputText operator()(const ControllerStopped& stopped) const {
    const std::string text = stopped.robot + " " + stopped.why;
    if (!stopped.robot.starts_with(kSupervisorLabel)) return {std::string(kStopped), text};
    return {std::string(kSupervisorStopped), text.substr(std::string_view(kSupervisorLabel).size())};
  }
};

std::optional<LossPolicy> PolicyOf(std::string_view word) {
  for (const LossPolicy policy : {LossPolicy::kHold, LossPolicy::kStop, LossPolicy::kDrop}) {
    if (word == ToString(policy)) return policy;
  }
  return std::nullopt;
}

/// Decodes an event of the robot that `detail` names first.
std::optional<RobotEvent> DecodeEvent(std::string_view action, std::string_view detail) {
  const std::size_t blank = detail.find(' ');
  if (blank == 0 || blank == std::string_view::npos) return std::nullopt;
  std::string robot(detail.substr(0, blank));
  const std::string_view rest = detail.substr(blank + 1);
  if (action == kStopped) return ControllerStopped{std::move(robot), std::string(rest)};
  if (action == kSupervisorStopped) return ControllerStopped{kSupervisorLabel + robot, std::string(rest)};
  const std::optional<LossPolicy> policy = PolicyOf(rest);
  if (!policy) return std::nullopt;
  if (action == kDeadline) return DeadlineFired{std::move(robot), *policy};
  return ClientLost{std::move(robot), *policy};
}

/// Decodes the line `action detail` as if sent to /simulation.
std::optional<RunEdit> DecodeEdit(std::string_view action, std::string_view detail) {
  if (Commands().Find(action) == nullptr) return std::nullopt;
  const std::string line = std::string(action) + " " + std::string(detail) + "\n";
  const Decoded decoded = DecodeText(line, Commands(), false);
  if (decoded.status != DecodeStatus::kMessage || decoded.consumed != line.size()) return std::nullopt;
  std::string ignored;
  return RunEditOf(decoded.message, ignored);
}

/// Decodes the line `action` as if sent to the module that `detail` names first.
std::optional<RunEdit> DecodeTuning(std::string_view action, std::string_view detail) {
  const std::size_t blank = detail.find(' '), slash = detail.find('/', 1);
  if (!detail.starts_with('/') || slash >= blank || blank == std::string_view::npos) return std::nullopt;
  const std::string line = std::string(action) + std::string(detail.substr(blank)) + "\n";
  const Decoded decoded = DecodeText(line, Boards(), false);
  if (decoded.status != DecodeStatus::kMessage || decoded.consumed != line.size()) return std::nullopt;
  const Message& request = decoded.message;
  const CommandSpec& spec = *Boards().Find(request.command);
  if (CheckRequest(spec, request.text, request.params, request.data).error != 0) return std::nullopt;
  return edit::TuneJoints{std::string(detail.substr(1, slash - 1)),
                          std::string(detail.substr(slash + 1, blank - slash - 1)), request.command,
                          request.params, request.data};
}

std::optional<RunEdit> SetStepTo(double step_s, std::string& error) {
  const double microseconds = std::round(step_s * 1e6);
  const bool in_range = step_s >= ToSeconds(kMinStep) && step_s <= ToSeconds(kMaxStep);
  if (!in_range) {
    error = fmt::format("a step lasts 0.0005 to 0.1 s, not {:.6g}: set_step 0.01", step_s);
    return std::nullopt;
  }
  if (std::abs(step_s * 1e6 - microseconds) > 1e-3) {
    error = fmt::format("a step lasts whole microseconds: set_step {:.6f}", microseconds * 1e-6);
    return std::nullopt;
  }
  return edit::SetStep{static_cast<Nanoseconds>(microseconds) * 1000};
}

/// Far beyond any run, yet well within 64 bits.
constexpr double kLongest_s = 1e9;

std::vector<EditAction> PlayAt(double factor, std::string& error) {
  if (IsPlaySpeed(factor)) return {edit::SetPlaySpeed{factor}};
  error = fmt::format("speed {}{}", factor, kNoPlaySpeed);
  return {};
}

std::vector<EditAction> Skip(int steps, std::string& error) {
  if (steps != 0) return {edit::Skip{steps}};
  error = "step takes a number of steps, below 0 to go back, not 0: step 1";
  return {};
}

}  // namespace

bool IsSupervisors(const RunInput& input) {
  const auto* change = As<WorldChange>(input.what);
  return change != nullptr && change->label.starts_with(kSupervisorLabel);
}

InputText Encode(const RunInput& input) {
  return std::visit([](const auto& kind) { return std::visit(TextOf(), kind); }, input.what);
}

std::optional<RunInput> DecodeInput(std::uint64_t step, std::string_view action, std::string_view detail,
                                    const SceneContext& context) {
  if (action == kEdit) {
    const std::size_t end = detail.find('\n');
    if (end == std::string_view::npos) return std::nullopt;
    std::optional<WorldChange> change = DecodeChange(detail.substr(end + 1), context);
    if (!change) return std::nullopt;
    change->label = detail.substr(0, end);
    return RunInput{step, WorldInput(*std::move(change))};
  }
  if (action == kDeadline || action == kDisconnect || action == kStopped || action == kSupervisorStopped) {
    std::optional<RobotEvent> event = DecodeEvent(action, detail);
    return event ? std::optional(RunInput{step, *std::move(event)}) : std::nullopt;
  }
  const CommandSpec* const board = Boards().Find(action);
  std::optional<RunEdit> edit =
      board != nullptr && IsTuning(board->id) ? DecodeTuning(action, detail) : DecodeEdit(action, detail);
  return edit ? std::optional(RunInput{step, *std::move(edit)}) : std::nullopt;
}

std::optional<RunEdit> RunEditOf(const Message& request, std::string& error) {
  switch (request.command) {
    case command::kRun:
      return edit::Run{};
    case command::kPause:
      return edit::Pause{};
    case command::kStep:
      return edit::Step{request.params[0]};
    case command::kSetMode:
      return edit::SetMode{static_cast<Mode>(request.params[0])};
    case command::kSetStep:
      return SetStepTo(request.data[0], error);
    case command::kSetSpeed:
      return edit::SetSpeed{request.data[0]};
    case command::kSetParticipants:
      return edit::SetParticipants{SplitWords(request.text)};
    case command::kStopAll:
      return edit::StopAll{};
    case command::kReleaseRobot:
      return edit::UnloadController{request.text.substr(request.text.starts_with('/') ? 1 : 0)};
    default:
      return std::nullopt;
  }
}

std::optional<WorldRequest> WorldEditOf(const Message& request, std::string& error) {
  switch (request.command) {
    case command::kReset:
      if (request.params.empty()) return edit::Reset{};
      if (request.params[0] >= 0) return edit::Reset{static_cast<std::uint64_t>(request.params[0])};
      error = "a seed is at least 0: reset 7";
      return std::nullopt;
    case command::kLoadScenario:
      return LoadRequest{request.text};
    case command::kReload:
      return LoadRequest{};
    case command::kRestoreState:
      return RestoreRequest{request.text};
    default:
      return std::nullopt;
  }
}

std::vector<EditAction> PlaybackEditsOf(const Message& request, std::string& error) {
  switch (request.command) {
    case command::kSeek:
      return {edit::Seek{std::llround(std::clamp(request.data[0], -kLongest_s, kLongest_s) * 1e9)}};
    case command::kPlay: {
      if (request.data.empty()) return {edit::Run{}};
      std::vector<EditAction> edits = PlayAt(request.data[0], error);
      if (!edits.empty()) edits.emplace_back(edit::Run{});
      return edits;
    }
    case command::kPausePlayback:
      return {edit::Pause{}};
    case command::kSetPlaySpeed:
      return PlayAt(request.data[0], error);
    case command::kSkip:
      return Skip(request.params.empty() ? 1 : request.params[0], error);
    case command::kSetLoop:
      return {edit::SetLoop{request.params[0] == 1}};
    default:
      return {};
  }
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/control/team_commands.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "server/model/drive.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

struct Kind {
  const char* name;
  ControlMode mode;
  bool wheels;
};

constexpr Kind kKinds[] = {
    {"velocities", ControlMode::kKeep, false},           {"wheels", ControlMode::kKeep, true},
    {"positions", ControlMode::kPosition, false},        {"positions_direct", ControlMode::kDirect, false},
    {"joint_velocities", ControlMode::kVelocity, false}, {"efforts", ControlMode::kEffort, false}};
constexpr const char* kExample = "step_all \"velocities positions/arm\"";

TeamCommands::Refusal NoSuchWord(const std::string& word) {
  constexpr std::size_t kShown = 40;
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) names.emplace_back(kind.name);
  return {Error::kWrongParams, "step_all takes " + JoinNames(names) + ", not " + word.substr(0, kShown) +
                                   DidYouMean(word.size() > kShown ? "" : word, names)};
}

/// The names of these robots' groups of joints: `arm, legs`.
std::string GroupsOf(const Scene& scene, std::span<const int> robots) {
  std::vector<std::string> groups;
  for (const int robot : robots) {
    for (const ActuatorModel& actuator :
         scene.robots[static_cast<std::size_t>(robot)].entry.model->actuators) {
      if (actuator.is_board() && std::ranges::find(groups, actuator.module) == groups.end())
        groups.push_back(actuator.module);
    }
  }
  return groups.empty() ? "they have none" : "there are " + JoinNames(groups);
}

TeamCommands::Refusal NotFinite(const std::string& word, const std::string& robot,
                                std::span<const double> row) {
  return {Error::kOutOfRange,
          fmt::format("step_all takes finite numbers, {} of {} are {} {}", word, robot, row[0], row[1])};
}

/// Converts forward and turn speed, or wheel speeds, to set-points. Returns true if limits applied. @pre
/// finite
[[gnu::always_inline]] inline bool SetWheels(const DriveModel& drive, bool wheels, const WheelSpeeds& pair,
                                             Setpoint* own) {
  double factor = 1;
  const WheelSpeeds speeds =
      wheels ? LimitWheels(drive, pair, factor) : WheelsFor(drive, pair[0], pair[1], factor);
  own[0] = Setpoint{speeds[0]};
  own[1] = Setpoint{speeds[1]};
  if (factor != 1) return true;
  return drive.steering && (wheels ? speeds != pair : LimitTurn(drive, pair[0], pair[1]) != pair[1]);
}

}  // namespace

bool TeamCommands::Word::sets(const ActuatorModel& actuator) const {
  return (sets_joints() ? actuator.is_board() : actuator.is_drive()) &&
         (group.empty() || group == actuator.module);
}

std::optional<TeamCommands::Refusal> TeamCommands::Read(std::string_view text) {
  words_.clear();
  for (const std::string& said : SplitWords(text)) {
    const std::size_t slash = said.find('/');
    const std::string name = said.substr(0, slash);
    const auto* const kind = std::ranges::find(kKinds, name, &Kind::name);
    if (kind == std::end(kKinds)) return NoSuchWord(said);
    Word word{said, kind->mode, kind->wheels, slash == std::string::npos ? "" : said.substr(slash + 1)};
    if (slash != std::string::npos && (!word.sets_joints() || word.group.empty()))
      return Refusal{Error::kWrongParams, fmt::format("{} names no group of joints: {}", said, kExample)};
    if (std::ranges::find(words_, said, &Word::name) != words_.end())
      return Refusal{Error::kWrongParams, fmt::format("{} is named twice: {}", said, kExample)};
    words_.push_back(std::move(word));
  }
  if (words_.empty()) words_.push_back({"velocities", ControlMode::kKeep, false, ""});
  return std::nullopt;
}

std::size_t TeamCommands::Columns(const Word& word, const Scene& scene, std::span<const int> robots) const {
  if (!word.sets_joints()) return 2;
  std::size_t most = 0;
  const RobotModel* last = nullptr;  // most robots of a team are of one type
  for (const int robot : robots) {
    const RobotModel* const model = scene.robots[static_cast<std::size_t>(robot)].entry.model.get();
    if (std::exchange(last, model) == model) continue;
    std::size_t count = 0;
    for (const ActuatorModel& actuator : model->actuators)
      if (word.sets(actuator)) count += actuator.joints.size();
    most = std::max(most, count);
  }
  return most;
}

std::optional<TeamCommands::Refusal> TeamCommands::Add(const Word& word, const SceneRobot& robot,
                                                       std::span<const double> row,
                                                       std::span<Setpoint> setpoints, bool& limited) const {
  const RobotModel& model = *robot.entry.model;
  for (const ActuatorModel& actuator : model.actuators) {
    const std::span<Setpoint> own = setpoints.first(actuator.joints.size());
    setpoints = setpoints.subspan(own.size());
    if (!word.sets(actuator)) continue;
    if (const auto* drive = std::get_if<DriveModel>(&actuator.kind)) {
      if (std::isnan(row[0]) && std::isnan(row[1])) continue;
      if (!std::isfinite(row[0]) || !std::isfinite(row[1]))
        return NotFinite(word.name, robot.entry.name, row);
      if (own.front().mode != ControlMode::kKeep)
        return Refusal{
            Error::kWrongParams,
            fmt::format(
                "step_all: {} are a second command for the wheels of {}: give one, and nan nan for the other",
                word.name, robot.entry.name)};
      limited |= SetWheels(*drive, word.wheels, {row[0], row[1]}, own.data());
      continue;
    }
    for (std::size_t i = 0; i < own.size(); ++i, row = row.subspan(1)) {
      if (std::isnan(row[0])) continue;
      const JointModel& joint = model.joints[static_cast<std::size_t>(actuator.joints[i])];
      const auto refuse = [&](Error error, const char* why) {
        return Refusal{
            error, fmt::format("step_all: {} of {}, {} {}", joint.name, robot.entry.name, word.name, why)};
      };
      if (std::isinf(row[0])) return refuse(Error::kOutOfRange, "is not finite; nan keeps its set-point");
      if (own[i].mode != ControlMode::kKeep)
        return refuse(Error::kWrongParams, "is its second command: give one, and nan for the other");
      own[i] = Limit(joint, {row[0], word.mode});
      limited |= own[i].reference != row[0];
    }
  }
  return std::nullopt;
}

std::optional<TeamCommands::Refusal> TeamCommands::Translate(const Scene& scene, std::span<const int> robots,
                                                             std::span<const double> data,
                                                             std::vector<Setpoint>& setpoints,
                                                             std::size_t& limited) const {
  setpoints.clear();
  limited = 0;
  std::vector<std::size_t> columns;
  std::size_t width = 0;
  std::string widths;
  for (const Word& word : words_) {
    columns.push_back(Columns(word, scene, robots));
    width += columns.back();
    widths += fmt::format("{}{} {}", widths.empty() ? "" : ", ", word.name, columns.back());
    if (columns.back() == 0) {
      return Refusal{Error::kNoSuchName, fmt::format("step_all: these robots have no joints for {}; {}",
                                                     word.name, GroupsOf(scene, robots))};
    }
  }
  if (data.size() != width * robots.size()) {
    return Refusal{
        Error::kWrongData,
        fmt::format("step_all takes {} data for each of {} robots ({}), {} in all, or none, not {}", width,
                    robots.size(), widths, width * robots.size(), data.size())};
  }
  if (is_only_wheels()) return TranslateWheels(scene, robots, data, setpoints, limited);
  for (const int index : robots) {
    const SceneRobot& robot = scene.robots[static_cast<std::size_t>(index)];
    const std::size_t first = setpoints.size();
    for (const ActuatorModel& actuator : robot.entry.model->actuators)
      setpoints.insert(setpoints.end(), actuator.joints.size(), {0, ControlMode::kKeep});
    const std::span<Setpoint> own = std::span(setpoints).subspan(first);
    bool was_limited = false;
    for (std::size_t i = 0; i < words_.size(); ++i) {
      if (std::optional<Refusal> refusal = Add(words_[i], robot, data.first(columns[i]), own, was_limited))
        return refusal;
      data = data.subspan(columns[i]);
    }
    if (was_limited) ++limited;
  }
  return std::nullopt;
}

std::optional<TeamCommands::Refusal> TeamCommands::TranslateWheels(const Scene& scene,
                                                                   std::span<const int> robots,
                                                                   std::span<const double> data,
                                                                   std::vector<Setpoint>& setpoints,
                                                                   std::size_t& limited) const {
  const Word& word = words_.front();
  std::size_t channels = 0;
  for (const int index : robots)
    channels += static_cast<std::size_t>(scene.robots[static_cast<std::size_t>(index)].channel_count);
  setpoints.assign(channels, {0, ControlMode::kKeep});
  Setpoint* own = setpoints.data();
  const RobotModel* last = nullptr;  // most robots of a team are of one type
  const DriveModel* drive = nullptr;
  std::size_t before = 0;  // channels before the drive's
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const SceneRobot& robot = scene.robots[static_cast<std::size_t>(robots[i])];
    const RobotModel* const model = robot.entry.model.get();
    if (std::exchange(last, model) != model) {
      drive = model->drive();
      before = 0;
      for (const ActuatorModel& actuator : model->actuators) {
        if (actuator.is_drive()) break;
        before += actuator.joints.size();
      }
    }
    if (drive != nullptr) {
      const WheelSpeeds row = {data[2 * i], data[2 * i + 1]};
      if (!std::isfinite(row[0]) || !std::isfinite(row[1]))
        return NotFinite(word.name, robot.entry.name, row);
      if (SetWheels(*drive, word.wheels, row, own + before)) ++limited;
    }
    own += robot.channel_count;
  }
  return std::nullopt;
}

}  // namespace coopdyn

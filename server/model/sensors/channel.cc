// SPDX-License-Identifier: MIT
// Reads `<coopdyn:channel>`: motors and values that are exchanged in one request.
#include <tinyxml2.h>

#include <array>
#include <numbers>
#include <utility>

#include "server/model/robot_model.h"
#include "server/model/sdf_sensors.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

using What = ChannelModel::Quantity;

constexpr std::pair<What, std::string_view> kQuantities[] = {{What::kPosition, "position"},
                                                             {What::kVelocity, "velocity"},
                                                             {What::kEffort, "effort"},
                                                             {What::kCurrent, "current"},
                                                             {What::kEnergy, "energy"},
                                                             {What::kX, "x"},
                                                             {What::kY, "y"},
                                                             {What::kZ, "z"},
                                                             {What::kRoll, "roll"},
                                                             {What::kPitch, "pitch"},
                                                             {What::kYaw, "yaw"},
                                                             {What::kVx, "vx"},
                                                             {What::kVy, "vy"},
                                                             {What::kVz, "vz"},
                                                             {What::kWx, "wx"},
                                                             {What::kWy, "wy"},
                                                             {What::kWz, "wz"},
                                                             {What::kAmbientLight, "ambient_light"}};

constexpr std::pair<ControlMode, std::string_view> kModes[] = {
    {ControlMode::kPosition, "position"}, {ControlMode::kDirect, "direct"},
    {ControlMode::kVelocity, "velocity"}, {ControlMode::kEffort, "effort"},
    {ControlMode::kPwm, "pwm"},           {ControlMode::kKeep, "ignored"}};
/// The mode of a motor that sets the maximum effort of another motor.
constexpr std::string_view kLimit = "limit";
/// Suffix of a limiter's name, after the joint's name.
constexpr const char* kLimiterEnd = " limit";

/// The value in `table` of the word in attribute `name`. Reports unknown words and returns nullopt.
template <typename T, std::size_t N>
std::optional<T> ReadWord(XmlAttributes& attributes, const std::string& name,
                          const std::pair<T, std::string_view> (&table)[N]) {
  const std::optional<std::string> text = attributes.Text(name);
  if (!text) return std::nullopt;
  std::vector<std::string> words;
  for (const auto& [value, word] : table) {
    if (word == *text) return value;
    words.emplace_back(word);
  }
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  attributes.Error("'" + name + "' is one of " + list + ", not '" + *text + "'" + DidYouMean(*text, words));
  return std::nullopt;
}

std::string ReadName(XmlAttributes& attributes) {
  attributes.Require("name");
  constexpr std::size_t kMaxName = 100;
  std::string name = attributes.Text("name").value_or("");
  const bool is_plain = std::ranges::all_of(name, [](char c) { return c > ' ' && c != 0x7f; });
  if (name.empty() || name.size() > kMaxName || !is_plain)
    attributes.Error("a name has 1 to " + std::to_string(kMaxName) + " letters, digits or signs, no blanks");
  return name;
}

ValueMap ReadMap(XmlAttributes& attributes) {
  constexpr double kMost = 1e9;
  ValueMap map;
  const auto internal = attributes.Numbers("internal", 2), external = attributes.Numbers("external", 2);
  const auto is_far = [](const std::vector<double>& of) {
    return std::abs(of[0]) > kMost || std::abs(of[1]) > kMost;
  };
  if (internal) {
    map.internal_min = (*internal)[0];
    map.internal_max = (*internal)[1];
    if (!(map.internal_min < map.internal_max) || is_far(*internal)) {
      attributes.Error("'internal' is the least and the greatest value, in SI units, at most 1e9");
      return {};
    }
  }
  if (external) {
    map.external_min = (*external)[0];
    map.external_max = (*external)[1];
    if (!internal) attributes.Error("'external' needs 'internal': the range that is mapped to it");
    if (map.external_min == map.external_max || is_far(*external)) {
      attributes.Error("the two ends of 'external' must differ, and be at most 1e9");
      return {};
    }
  }
  return map;
}

ValueFilter ReadFilter(XmlAttributes& attributes) {
  using Kind = ValueFilter::Kind;
  constexpr std::pair<Kind, std::string_view> kKinds[] = {
      {Kind::kNone, "none"}, {Kind::kMean, "mean"}, {Kind::kMedian, "median"}, {Kind::kLowPass, "low_pass"}};
  constexpr double kLeast_s = 1e-6, kMost_s = 1e4;
  ValueFilter filter;
  filter.kind = ReadWord(attributes, "filter", kKinds).value_or(Kind::kNone);
  const auto steps = attributes.Integer("filter_steps", 1, ValueFilter::kMaxSteps);
  const auto time_s = attributes.Number("filter_time_s", kLeast_s, kMost_s);
  filter.steps = steps.value_or(1);
  filter.time_s = time_s.value_or(1);
  const bool is_low_pass = filter.kind == Kind::kLowPass, counts = !is_low_pass && filter.kind != Kind::kNone;
  if (counts) attributes.Require("filter_steps");
  if (is_low_pass) attributes.Require("filter_time_s");
  if ((steps && !counts) || (time_s && !is_low_pass))
    attributes.Error(
        "filter=\"mean\" and \"median\" have 'filter_steps', filter=\"low_pass\" has 'filter_time_s'");
  return filter;
}

MappedNoise ReadMappedNoise(XmlAttributes& attributes) {
  using Kind = MappedNoise::Kind;
  constexpr std::pair<Kind, std::string_view> kKinds[] = {
      {Kind::kNone, "none"}, {Kind::kUniform, "uniform"}, {Kind::kGaussian, "gaussian"}};
  constexpr double kMost = 1e9;
  MappedNoise noise;
  noise.kind = ReadWord(attributes, "noise", kKinds).value_or(Kind::kNone);
  noise.sigma = attributes.Number("noise_sigma", 0, kMost).value_or(0);
  noise.mean = attributes.Number("noise_mean", -kMost, kMost).value_or(0);
  return noise;
}

/// Index into `all` of the item `name`. Reports an error and returns nullopt if unknown.
template <typename T>
std::optional<std::size_t> FindNamed(XmlAttributes& attributes, const char* what, const std::string& name,
                                     const std::vector<T>& all) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].name == name) return i;
    names.push_back(all[i].name);
  }
  attributes.Error(std::string("there is no ") + what + " '" + name + "'" + DidYouMean(name, names));
  return std::nullopt;
}

ChannelModel::Motor ReadMotor(XmlAttributes& attributes, const RobotModel& robot) {
  ChannelModel::Motor motor;
  motor.line = attributes.where().line;
  motor.name = ReadName(attributes);
  attributes.Require("joint");
  motor.joint = attributes.Text("joint").value_or("");
  const bool limits = attributes.Text("mode") == kLimit;
  if (limits) {
    motor.mode = ControlMode::kDirect;
  } else {
    motor.mode = ReadWord(attributes, "mode", kModes).value_or(ControlMode::kVelocity);
  }
  if (motor.mode == ControlMode::kKeep) motor.channel = ChannelModel::Motor::kNone;
  motor.map = ReadMap(attributes);
  motor.noise = ReadMappedNoise(attributes);
  if (FindNamed(attributes, "joint", motor.joint, robot.joints) && limits) motor.joint += kLimiterEnd;
  return motor;
}

ChannelModel::Value ReadValue(XmlAttributes& attributes, const SensorSource& source) {
  ChannelModel::Value value;
  value.line = attributes.where().line;
  value.name = ReadName(attributes);
  const auto module = attributes.Text("module"), joint = attributes.Text("joint");
  const auto quantity = ReadWord(attributes, "of", kQuantities);
  const std::optional<int> index = attributes.Integer("index", 1, 1'000'000);
  value.map = ReadMap(attributes);
  value.noise = ReadMappedNoise(attributes);
  value.filter = ReadFilter(attributes);
  value.auxiliary = attributes.Flag("auxiliary").value_or(false);
  if (module) {
    value.of = *module;
    value.index = static_cast<std::size_t>(index.value_or(1) - 1);
    if (quantity || joint) attributes.Error("a value of a module has no 'of' and no 'joint': write 'index'");
    return value;
  }
  if (index) attributes.Error("'index' needs 'module': of whose reading it is");
  if (attributes.Text("of") && !quantity) return value;
  value.quantity = quantity.value_or(What::kPosition);
  if (joint) {
    value.of = *joint;
    if (value.quantity > What::kEnergy)
      attributes.Error("'of' a joint is position, velocity, effort, current or energy");
    if (const auto found = FindNamed(attributes, "joint", *joint, source.robot.joints)) {
      value.source = *found;
      if (!source.robot.joints[*found].has_axis() && source.robot.joints[*found].joins())
        attributes.Error("the joint '" + *joint + "' has no axis to measure");
      const bool has_train = source.robot.joints[*found].drive_train.has_value();
      if (value.quantity == What::kCurrent && !has_train)
        attributes.Error("the joint '" + *joint + "' has no <coopdyn:drivetrain>, whose current it would be");
      value.sums_work = value.quantity == What::kEnergy && !has_train;
    }
  } else if (value.quantity == What::kAmbientLight) {
    return value;
  } else if (quantity && *quantity > What::kEnergy) {
    value.mount = source.ReadMount(attributes);
    constexpr std::pair<bool, std::string_view> kFrames[] = {{false, "world"}, {true, "body"}};
    value.in_body = ReadWord(attributes, "frame", kFrames).value_or(false);
    if (value.in_body && value.quantity < What::kVx)
      attributes.Error("frame=\"body\" is for velocities: vx vy vz wx wy wz");
  } else {
    attributes.Error(
        "says nothing to measure: write module=\"sonar\" index=\"1\", joint=\"knee\" of=\"position\", "
        "link=\"body\" of=\"x\" or of=\"ambient_light\"");
  }
  return value;
}

}  // namespace

std::string_view ToString(ChannelModel::Quantity quantity) {
  for (const auto& [one, word] : kQuantities) {
    if (one == quantity) return word;
  }
  return "";
}

void ChannelModel::Read(const SensorSource& source) {
  if (auto v = source.attributes.Integer("steps", 1, 1'000'000)) steps = *v;
  if (auto v = source.attributes.Integer("port", 1, 65535)) port = *v;
  for (std::string& name : SplitWords(source.attributes.Text("abort").value_or("")))
    abort.push_back(std::move(name));
  source.ForEachChild({"coopdyn:motor", "coopdyn:value"}, [&](XmlAttributes& child, std::string_view name) {
    if (motors.size() + values.size() == ChannelModel::kMaxValues)
      child.Error("a channel has at most " + std::to_string(ChannelModel::kMaxValues) + " motors and values");
    if (motors.size() + values.size() >= ChannelModel::kMaxValues) return;
    if (name == "coopdyn:motor") {
      motors.push_back(ReadMotor(child, source.robot));
    } else {
      values.push_back(ReadValue(child, source));
    }
  });
}

std::vector<std::string> ChannelModel::ValueNames() const {
  std::vector<std::string> names;
  for (std::size_t i = 0, number = 0; i < values.size(); ++i) {
    const std::string& name = values[i].name;
    number = i > 0 && values[i - 1].name == name ? number + 1 : 1;
    const bool has_more = i + 1 < values.size() && values[i + 1].name == name;
    names.push_back(number > 1 || has_more ? name + "_" + std::to_string(number) : name);
  }
  return names;
}

std::string ChannelModel::Text(const RobotModel& /*robot*/) const {
  return CountOf(motors.size(), "motor") + ", " + CountOf(values.size(), "value") +
         (steps > 1 ? ", every " + CountOf(static_cast<std::size_t>(steps), "step") : "");
}

void ReadLimiters(const tinyxml2::XMLElement& model, RobotModel& robot) {
  std::vector<int> limiters;
  for (const auto* channel = model.FirstChildElement("coopdyn:channel"); channel != nullptr;
       channel = channel->NextSiblingElement("coopdyn:channel")) {
    for (const auto* motor = channel->FirstChildElement("coopdyn:motor"); motor != nullptr;
         motor = motor->NextSiblingElement("coopdyn:motor")) {
      const char *mode = motor->Attribute("mode"), *name = motor->Attribute("joint");
      if (mode == nullptr || name == nullptr || mode != kLimit) continue;
      const auto found = std::ranges::find(robot.joints, name, &JointModel::name);
      const std::string limiter_name = std::string(name) + kLimiterEnd;
      if (found == robot.joints.end() || !found->joins() || found->drive_train) continue;
      if (std::ranges::find(robot.joints, limiter_name, &JointModel::name) != robot.joints.end()) continue;
      JointModel limiter;
      limiter.kind = JointModel::Kind::kLimiter;
      limiter.name = limiter_name;
      limiter.parent = limiter.child = found->parent;
      limiter.limits = static_cast<int>(found - robot.joints.begin());
      limiter.lower = 0;
      limiter.upper = limiter.max_effort = found->max_effort;
      limiters.push_back(static_cast<int>(robot.joints.size()));
      robot.joints.push_back(std::move(limiter));
    }
  }
  // The space keeps the name distinct from all module names.
  if (!limiters.empty()) robot.actuators.push_back({"motor limits", std::move(limiters), LimitersModel()});
}

namespace {

/// A joint's index among the channels of `robot`, and its actuator; nullopt if no module drives it.
std::optional<std::pair<std::size_t, const ActuatorModel*>> FindDriven(const RobotModel& robot,
                                                                       const std::string& name) {
  std::size_t next = 0;
  for (const ActuatorModel& actuator : robot.actuators) {
    for (const int joint : actuator.joints) {
      if (!actuator.module.empty() && robot.joints[static_cast<std::size_t>(joint)].name == name)
        return {{next, &actuator}};
      ++next;
    }
  }
  return std::nullopt;
}

/// True if `value` is the angle of a hinge without a motor that may exceed a turn.
bool CountsTurns(const RobotModel& robot, const ChannelModel::Value& value) {
  if (value.quantity != What::kPosition) return false;
  const JointModel& joint = robot.joints[value.source];
  const auto drives = [&](const ActuatorModel& actuator) {
    return std::ranges::find(actuator.joints, static_cast<int>(value.source)) != actuator.joints.end();
  };
  return joint.kind == JointModel::Kind::kHinge && std::ranges::none_of(robot.actuators, drives) &&
         (value.map.internal_min < joint.start - std::numbers::pi ||
          value.map.internal_max > joint.start + std::numbers::pi);
}

constexpr const char* kNeedsLimit = "': give it <limit> with effort and velocity, and a module";

}  // namespace

void Connect(ChannelModel& channel, const RobotModel& robot, const std::string& file,
             Diagnostics& diagnostics) {
  std::vector<std::string> modules;
  for (const SensorModel& sensor : robot.sensors) modules.push_back(sensor.name);
  const auto find = [&](const std::string& name, int line) -> const SensorModel* {
    for (const SensorModel& sensor : robot.sensors) {
      if (sensor.name == name) return &sensor;
    }
    diagnostics.Error({file, line}, "the channel names a module '" + name + "' that is no sensor's" +
                                        DidYouMean(name, modules));
    return nullptr;
  };
  std::size_t cells = 0;
  for (ChannelModel::Value& value : channel.values) {
    value.counts_turns = CountsTurns(robot, value);
    value.first_cell = cells;
    cells += value.cells();
    if (value.sums_work) {
      const auto driven = FindDriven(robot, value.of);
      if (!driven)
        diagnostics.Error({file, value.line}, "no motor drives the joint '" + value.of + kNeedsLimit);
      if (driven) value.channel = driven->first;
    }
    if (value.quantity != What::kReading) continue;
    const SensorModel* const sensor = find(value.of, value.line);
    if (sensor == nullptr) continue;
    value.source = static_cast<std::size_t>(sensor - robot.sensors.data());
    if (std::holds_alternative<ChannelModel>(sensor->kind))
      diagnostics.Error({file, value.line}, "a channel cannot carry the values of a channel");
    const std::size_t count = FixedCount(sensor->kind);
    if (value.index >= count)
      diagnostics.Error({file, value.line}, "the reading of '" + value.of + "' has " + std::to_string(count) +
                                                " values of a fixed number: index " +
                                                std::to_string(value.index + 1) + " is none of them");
  }
  for (const std::string& name : channel.abort) {
    const SensorModel* const sensor = find(name, channel.values.empty() ? 0 : channel.values.front().line);
    if (sensor == nullptr) continue;
    channel.aborts.push_back(static_cast<std::size_t>(sensor - robot.sensors.data()));
    if (!std::holds_alternative<ContactModel>(sensor->kind))
      diagnostics.Error({file, 0}, "'abort' of a channel names contact modules: '" + name + "' is none");
  }
  for (ChannelModel::Motor& motor : channel.motors) {
    if (motor.channel == ChannelModel::Motor::kNone) continue;
    const auto driven = FindDriven(robot, motor.joint);
    if (!driven) {
      if (motor.joint.ends_with(kLimiterEnd)) {
        diagnostics.Error({file, motor.line},
                          "mode=\"limit\" is for the motor of a joint without a drive train");
      } else {
        diagnostics.Error({file, motor.line}, "no module drives the joint '" + motor.joint + kNeedsLimit);
      }
      continue;
    }
    motor.channel = driven->first;
    const ActuatorModel& actuator = *driven->second;
    if (actuator.is_thrusters() && motor.mode != ControlMode::kEffort)
      diagnostics.Error({file, motor.line}, "a thruster takes mode=\"effort\" only: its force or torque");
    if (actuator.is_muscles() && motor.mode != ControlMode::kPwm)
      diagnostics.Error({file, motor.line}, "a muscle takes mode=\"pwm\" only: its activation");
    if (actuator.is_drive() && motor.mode != ControlMode::kVelocity)
      diagnostics.Error({file, motor.line}, "a wheel of a drive takes mode=\"velocity\" only");
  }
}

}  // namespace coopdyn

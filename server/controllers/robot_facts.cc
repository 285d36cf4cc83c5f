// SPDX-License-Identifier: MIT
#include "server/controllers/robot_facts.h"

#include <algorithm>

#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

/// Module and type of `sensors`, each ending with 0.
std::string SensorTexts(const RobotModel& model, std::span<const std::size_t> sensors) {
  std::string texts;
  for (const std::size_t sensor : sensors) {
    for (const std::string& text : {model.sensors[sensor].name, std::string(model.sensors[sensor].type())}) {
      texts.append(text.c_str(), text.size() + 1);
    }
  }
  return texts;
}

/// The facts of a sensor, without its texts.
coopdyn_sensor FactsOf(const SensorModel& sensor) {
  coopdyn_sensor of{};
  of.value_count = FixedCount(sensor.kind);
  if (const auto* camera = std::get_if<CameraModel>(&sensor.kind)) {
    of.width = static_cast<std::uint32_t>(camera->width);
    of.height = static_cast<std::uint32_t>(camera->height);
  }
  return of;
}

/// The names of a channel's motors and values, each ending with 0.
std::string LinkTexts(const ChannelModel& channel) {
  std::string texts;
  for (const ChannelModel::Motor& motor : channel.motors)
    texts.append(motor.name.c_str(), motor.name.size() + 1);
  for (const ChannelModel::Value& value : channel.values)
    texts.append(value.name.c_str(), value.name.size() + 1);
  return texts;
}

/// The facts of a motor or a value, without its name.
coopdyn_mapped FactsOf(const ValueMap& map, bool auxiliary) {
  return {.name = nullptr,
          .internal_min = map.internal_min,
          .internal_max = map.internal_max,
          .external_min = map.external_min,
          .external_max = map.external_max,
          .auxiliary = auxiliary ? 1u : 0u};
}

std::string OptionTexts(const ControllerChoice& choice) {
  std::string texts;
  for (const auto& [name, value] : choice.options) texts.append(name.c_str(), name.size() + 1);
  return texts;
}

std::size_t ImageBytes(const coopdyn_sensor& sensor) {
  return std::size_t{3} * sensor.width * sensor.height;
}

}  // namespace

std::string JointTexts(const RobotModel& model) {
  std::string texts;
  for (const ActuatorModel& actuator : model.actuators) {
    for (const int joint : actuator.joints) {
      for (const std::string& text : {actuator.module, model.joints[static_cast<std::size_t>(joint)].name}) {
        texts.append(text.c_str(), text.size() + 1);
      }
    }
  }
  return texts;
}

std::vector<coopdyn_joint> JointsOf(const RobotModel& model) {
  std::vector<coopdyn_joint> joints;
  for (const ActuatorModel& actuator : model.actuators) {
    // The modes that physics supports; a joint without a module takes no commands.
    std::uint32_t modes = 1u << COOPDYN_OFF;
    if (actuator.is_board()) {
      modes |= 1u << COOPDYN_POSITION | 1u << COOPDYN_DIRECT | 1u << COOPDYN_EFFORT;
    }
    if (actuator.is_muscles()) modes |= 1u << COOPDYN_PWM;
    if (actuator.is_thrusters()) modes |= 1u << COOPDYN_EFFORT;
    if (!actuator.module.empty() && (actuator.is_board() || actuator.is_drive()))
      modes |= 1u << COOPDYN_VELOCITY;
    const auto* drive = std::get_if<DriveModel>(&actuator.kind);
    for (const int index : actuator.joints) {
      const JointModel& of = model.joints[static_cast<std::size_t>(index)];
      joints.push_back({.module = nullptr,
                        .name = nullptr,
                        .modes = modes | (of.drive_train && actuator.is_board() ? 1u << COOPDYN_PWM : 0u),
                        .max_velocity = drive != nullptr ? drive->max_wheel_speed_rad_s : of.max_velocity,
                        .slides = of.slides() ? 1u : 0u,
                        .lower = of.lower,
                        .upper = of.upper,
                        .max_effort = of.max_effort,
                        .point_m = {of.p_RJ.x(), of.p_RJ.y(), of.p_RJ.z()},
                        .axis = {of.axis_R.x(), of.axis_R.y(), of.axis_R.z()}});
    }
  }
  return joints;
}

void PlaceSensors(const RobotModel& model, std::span<const std::size_t> wanted, Layout& in,
                  RobotSetup& setup) {
  setup.robot.sensor_count = wanted.size();
  setup.sensors = in.Add<coopdyn_sensor>(wanted.size());
  setup.sensor_text_bytes = SensorTexts(model, wanted).size();
  setup.sensor_texts = in.Add<char>(setup.sensor_text_bytes);
  setup.sensed = in.Add<SensorPlace>(wanted.size());
  // Places of the readings: WriteSensors() repeats this order.
  setup.readings_begin = in.end();
  for (const std::size_t sensor : wanted) {
    const coopdyn_sensor facts = FactsOf(model.sensors[sensor]);
    in.Add<double>(facts.value_count);
    in.Add<std::uint8_t>(ImageBytes(facts));
  }
}

void WriteSensors(const RobotModel& model, std::span<const std::size_t> wanted, const Areas& areas,
                  const RobotSetup& setup) {
  Layout layout(setup.readings_begin);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const coopdyn_sensor facts = FactsOf(model.sensors[wanted[i]]);
    areas.in.At<coopdyn_sensor>(setup.sensors)[i] = facts;
    SensorPlace& place = areas.in.At<SensorPlace>(setup.sensed)[i];
    place.values = layout.Add<double>(facts.value_count);
    place.image = layout.Add<std::uint8_t>(ImageBytes(facts));
    place.step = 0;
  }
  std::ranges::copy(SensorTexts(model, wanted), areas.in.At<char>(setup.sensor_texts));
}

void PlaceMapped(const RobotModel& model, Nanoseconds step, Layout& in, Layout& out, RobotSetup& setup) {
  const auto* const channel = model.Find<ChannelModel>();
  if (channel == nullptr) return;
  setup.robot.motor_count = channel->motors.size();
  setup.robot.mapped_count = channel->values.size();
  setup.exchange_steps = static_cast<std::uint64_t>(channel->steps);
  setup.robot.exchange_s = ToSeconds(step) * channel->steps;
  setup.links = in.Add<coopdyn_mapped>(channel->motors.size() + channel->values.size());
  setup.link_text_bytes = LinkTexts(*channel).size();
  setup.link_texts = in.Add<char>(setup.link_text_bytes);
  setup.mapped = in.Add<double>(channel->values.size());
  setup.motors = out.Add<double>(channel->motors.size());
}

void WriteMapped(const RobotModel& model, const Areas& areas, const RobotSetup& setup) {
  if (setup.link_text_bytes == 0) return;
  const auto* const channel = model.Find<ChannelModel>();
  auto* link = areas.in.At<coopdyn_mapped>(setup.links);
  for (const ChannelModel::Motor& motor : channel->motors) *link++ = FactsOf(motor.map, false);
  for (const ChannelModel::Value& value : channel->values) *link++ = FactsOf(value.map, value.auxiliary);
  std::ranges::copy(LinkTexts(*channel), areas.in.At<char>(setup.link_texts));
}

void PlaceOptions(const ControllerChoice& choice, Layout& in, RobotSetup& setup) {
  setup.robot.option_count = choice.options.size();
  setup.option_text_bytes = OptionTexts(choice).size();
  setup.option_texts = in.Add<char>(setup.option_text_bytes);
}

void WriteOptions(const ControllerChoice& choice, const Areas& areas, const RobotSetup& setup) {
  if (setup.option_text_bytes == 0) return;
  std::ranges::copy(OptionTexts(choice), areas.in.At<char>(setup.option_texts));
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/controllers/instance.h"

#include <cstring>

namespace coopdyn {

namespace {

/// `count` values at a place of the `in` area.
template <typename T>
std::vector<T> CopyOf(const Areas& areas, Place place, std::size_t count) {
  const T* const values = areas.in.At<T>(place);
  return {values, values + count};
}

/// Iterates over consecutive texts that end with 0.
class TextRow {
 public:
  explicit TextRow(const std::string& texts) : next_(texts.c_str()) {}
  const char* Next() {
    const char* const text = next_;
    next_ += std::strlen(text) + 1;
    return text;
  }

 private:
  const char* next_;
};

}  // namespace

Instance::Instance(const Plugin& made_by, const RobotSetup& setup, const Areas& areas)
    : plugin(&made_by),
      joints(CopyOf<coopdyn_joint>(areas, setup.joints, setup.robot.channel_count)),
      sensed(setup.robot.sensor_count),
      robot(setup.robot),
      name_(areas.in.At<char>(setup.name)),
      joint_texts_(areas.in.At<char>(setup.joint_texts), setup.joint_text_bytes),
      sensor_texts_(areas.in.At<char>(setup.sensor_texts), setup.sensor_text_bytes),
      link_texts_(areas.in.At<char>(setup.link_texts), setup.link_text_bytes),
      option_texts_(areas.in.At<char>(setup.option_texts), setup.option_text_bytes),
      bearing_rad_(CopyOf<double>(areas, setup.bearing_rad, robot.distance_count)),
      opening_rad_(CopyOf<double>(areas, setup.opening_rad, robot.distance_count)),
      max_m_(CopyOf<double>(areas, setup.max_m, robot.distance_count)),
      sensors_(CopyOf<coopdyn_sensor>(areas, setup.sensors, robot.sensor_count)),
      links_(CopyOf<coopdyn_mapped>(areas, setup.links, robot.motor_count + robot.mapped_count)) {
  TextRow joint_row(joint_texts_), sensor_row(sensor_texts_), link_row(link_texts_),
      option_row(option_texts_);
  for (coopdyn_joint& joint : joints) {
    joint.module = joint_row.Next();
    joint.name = joint_row.Next();
  }
  for (coopdyn_sensor& sensor : sensors_) {
    sensor.module = sensor_row.Next();
    sensor.type = sensor_row.Next();
  }
  for (coopdyn_mapped& link : links_) link.name = link_row.Next();
  for (const double value : CopyOf<double>(areas, setup.options, robot.option_count))
    options_.push_back({option_row.Next(), value});
  robot.name = name_.c_str();
  robot.channels = joints.data();
  robot.distance_bearing_rad = bearing_rad_.data();
  robot.distance_opening_rad = opening_rad_.data();
  robot.distance_max_m = max_m_.data();
  robot.sensors = sensors_.data();
  robot.motors = links_.data();
  robot.mapped = links_.data() + robot.motor_count;
  robot.options = options_.data();
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/model/robot_model.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

Setpoint Limit(const JointModel& joint, Setpoint setpoint) {
  if (joint.muscle) {
    if (setpoint.mode != ControlMode::kPwm) return {0, ControlMode::kIdle};
    return {std::clamp(setpoint.reference, 0.0, 1.0), ControlMode::kPwm};
  }
  if (joint.limits >= 0 && setpoint.mode != ControlMode::kDirect) return {0, ControlMode::kIdle};
  if (joint.thrusts() && setpoint.mode != ControlMode::kEffort) return {0, ControlMode::kIdle};
  switch (setpoint.mode) {
    case ControlMode::kPosition:
    case ControlMode::kDirect:
      setpoint.reference = std::clamp(setpoint.reference, joint.lower, joint.upper);
      break;
    case ControlMode::kVelocity:
      setpoint.reference = std::clamp(setpoint.reference, -joint.max_velocity, joint.max_velocity);
      break;
    case ControlMode::kEffort:
      setpoint.reference = std::clamp(setpoint.reference, -joint.max_effort, joint.max_effort);
      break;
    case ControlMode::kPwm:
      if (!joint.drive_train) return {0, ControlMode::kIdle};
      setpoint.reference = std::clamp(setpoint.reference, -1.0, 1.0);
      break;
    case ControlMode::kIdle:
    case ControlMode::kKeep:
      setpoint.reference = 0;
  }
  return setpoint;
}

const char* ToString(JointModel::Kind kind) {
  switch (kind) {
    case JointModel::Kind::kHinge:
      return "hinge";
    case JointModel::Kind::kSlider:
      return "slider";
    case JointModel::Kind::kBall:
      return "ball";
    case JointModel::Kind::kUniversal:
      return "universal";
    case JointModel::Kind::kScrew:
      return "screw";
    case JointModel::Kind::kMuscle:
      return "muscle";
    case JointModel::Kind::kForce:
      return "force";
    case JointModel::Kind::kTorque:
      return "torque";
    case JointModel::Kind::kLimiter:
      return "limiter";
  }
  return "";
}

const char* ActuatorModel::type() const {
  if (is_board()) return "joints";
  if (is_drive()) return "motors";
  return is_muscles() ? "muscles" : "thrusters";
}

std::vector<std::string> RobotModel::actuator_modules() const {
  std::vector<std::string> names;
  for (const ActuatorModel& actuator : actuators) {
    if (!actuator.module.empty() && !actuator.is_limiters()) names.push_back(actuator.module);
  }
  return names;
}

std::vector<ModuleModel> RobotModel::modules() const {
  std::vector<ModuleModel> modules;
  for (const ActuatorModel& actuator : actuators) {
    if (!actuator.module.empty() && !actuator.is_limiters())
      modules.push_back({actuator.type(), actuator.module});
  }
  for (const SensorModel& sensor : sensors) modules.push_back({sensor.type(), sensor.name});
  return modules;
}

void RobotModel::AddSensor(std::string name, SensorKind kind, const SensorTiming& timing) {
  const auto place = std::find_if(sensors.begin(), sensors.end(), [&kind](const SensorModel& other) {
    return other.kind.index() > kind.index();
  });
  sensors.insert(place, {std::move(name), std::move(kind), timing});
}

std::size_t RobotModel::NumberOf(std::size_t sensor) const {
  std::size_t number = 0;
  while (number < sensor && sensors[sensor - number - 1].kind.index() == sensors[sensor].kind.index()) {
    ++number;
  }
  return number;
}

std::size_t RobotModel::FirstMeasured(std::size_t sensor) const {
  std::size_t first = 0;
  for (std::size_t i = 0; i < sensor && i < sensors.size(); ++i) first += MeasuredCount(sensors[i].kind);
  return first;
}

std::vector<SectorModel> RobotModel::sectors() const {
  std::vector<SectorModel> all;
  for (std::size_t i = 0; const DistanceModel* distance = Find<DistanceModel>(i); ++i) {
    all.insert(all.end(), distance->sectors.begin(), distance->sectors.end());
  }
  return all;
}

std::size_t RobotModel::sector_count() const {
  std::size_t count = 0;
  for (std::size_t i = 0; const DistanceModel* distance = Find<DistanceModel>(i); ++i) {
    count += distance->sectors.size();
  }
  return count;
}

int RobotModel::message_delay_steps() const {
  int steps = 0;
  for (std::size_t i = 0; const NeighboursModel* neighbours = Find<NeighboursModel>(i); ++i) {
    if (neighbours->message_range_m > 0) steps = std::max(steps, neighbours->delay_steps);
  }
  return steps;
}

std::size_t RobotModel::FirstChannel(const ActuatorModel& actuator) const {
  std::size_t first = 0;
  for (const ActuatorModel* before = actuators.data(); before != &actuator; ++before)
    first += before->joints.size();
  return first;
}

bool RobotModel::has_limbs() const {
  const ActuatorModel* drive = drive_actuator();
  return fixed_base || has_loose || joints.size() > (drive == nullptr ? 0 : drive->joints.size());
}

bool RobotModel::has_boards() const {
  return std::ranges::any_of(actuators, &ActuatorModel::is_board);
}

bool RobotModel::IsDriven(int joint) const {
  return std::ranges::any_of(actuators, [joint](const ActuatorModel& actuator) {
    const auto* drive = std::get_if<DriveModel>(&actuator.kind);
    const bool steers = drive != nullptr && drive->steering &&
                        std::ranges::find(drive->steering->joints, joint) != drive->steering->joints.end();
    return steers || std::ranges::find(actuator.joints, joint) != actuator.joints.end();
  });
}

const CouplingModel* RobotModel::FindCoupling(int joint) const {
  const auto found = std::ranges::find(couplings, joint, &CouplingModel::follower);
  return found == couplings.end() ? nullptr : &*found;
}

const ActuatorModel* RobotModel::drive_actuator() const {
  for (const ActuatorModel& actuator : actuators) {
    if (std::holds_alternative<DriveModel>(actuator.kind)) return &actuator;
  }
  return nullptr;
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Readings and set-points of a robot's channel modules.
#include <cmath>

#include "server/base/portable_math.h"
#include "server/sensing/channel_filters.h"
#include "server/sensing/range_noise.h"
#include "server/sensing/readings.h"
#include "server/state/noise.h"

namespace coopdyn {

namespace {

using Quantity = ChannelModel::Quantity;

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

/// Position and velocity of a joint without motor, from its two bodies.
struct JointState {
  double position = 0, velocity = 0;
};

/// World velocity of a point fixed to a link.
Vector3 PointVelocity(const Frame& frame, int robot, int link, const Vector3& p_W) {
  const SceneRobot& of = frame.scene->robots[static_cast<std::size_t>(robot)];
  const BodyState& body = frame.bodies[static_cast<std::size_t>(of.first_body) +
                                       static_cast<std::size_t>(of.one_body() ? 0 : link)];
  return body.v_WB + body.w_WB.cross(p_W - body.p_WB);
}

JointState StateOf(const Frame& frame, int robot, const JointModel& joint) {
  const RobotModel& model = ModelOf(frame, robot);
  // The model frame R as a link carries it.
  const auto carried = [&](int link) {
    return LinkPose(frame, robot, link) * model.links[static_cast<std::size_t>(link)].X_RL.Inverse();
  };
  const Pose X_WP = carried(joint.parent), X_WC = carried(joint.child);
  const Vector3 axis_W = X_WP.q * joint.axis_R, p_W = X_WC * joint.p_RJ;
  if (joint.slides()) {
    const Vector3 v_W =
        PointVelocity(frame, robot, joint.child, p_W) - PointVelocity(frame, robot, joint.parent, p_W);
    return {joint.start + axis_W.dot(p_W - X_WP * joint.p_RJ), axis_W.dot(v_W)};
  }
  const Quaternion q_PC = X_WP.q.conjugate() * X_WC.q;
  const double turned_rad = WrapAngle(2 * portable::Atan2(q_PC.vec().dot(joint.axis_R), q_PC.w()));
  const Vector3 w_W = LinkTurn(frame, robot, joint.child) - LinkTurn(frame, robot, joint.parent);
  return {joint.start + turned_rad, axis_W.dot(w_W)};
}

/// The channel of a joint; null if no motor drives it.
const ChannelState* FindChannel(const Frame& frame, int robot, std::size_t joint) {
  const SceneRobot& of = frame.scene->robots[static_cast<std::size_t>(robot)];
  for (int i = 0; i < of.channel_count; ++i) {
    const auto channel = static_cast<std::size_t>(of.first_channel) + static_cast<std::size_t>(i);
    if (frame.scene->channels[channel].joint == static_cast<int>(joint)) return &frame.channels[channel];
  }
  return nullptr;
}

/// `cells`: the value's measured cells.
double JointValue(const Frame& frame, int robot, const ChannelModel::Value& value,
                  std::span<const double> cells) {
  if (value.sums_work) {
    // Wheels without their own bodies have no effort.
    const bool is_measured =
        !frame.scene->robots[static_cast<std::size_t>(robot)].one_body() && !cells.empty();
    return is_measured ? cells.front() : kNoValue;
  }
  if (value.quantity > Quantity::kEffort) {
    const DriveTrainState* const train = DriveTrainOf(frame, robot, static_cast<int>(value.source));
    if (train == nullptr) return kNoValue;
    return value.quantity == Quantity::kCurrent ? train->current_a : train->energy_j;
  }
  if (value.counts_turns)
    return cells.empty() ? kNoValue : ModelOf(frame, robot).joints[value.source].start + cells.front();
  const ChannelState* const channel = FindChannel(frame, robot, value.source);
  const JointModel& joint = ModelOf(frame, robot).joints[value.source];
  if (channel != nullptr) {
    if (value.quantity == Quantity::kPosition) return channel->position;
    return value.quantity == Quantity::kVelocity ? channel->velocity : channel->effort;
  }
  const JointState state = StateOf(frame, robot, joint);
  if (value.quantity == Quantity::kPosition) return state.position;
  if (value.quantity == Quantity::kVelocity) return state.velocity;
  return -joint.stiffness * (state.position - joint.rest) - joint.damping * state.velocity;
}

double PlaceValue(const Frame& frame, int robot, const ChannelModel::Value& value) {
  const Pose X_WS = MountPose(frame, robot, value.mount);
  const auto coordinate = [&](Quantity first, const Vector3& v) {
    return v[static_cast<int>(value.quantity) - static_cast<int>(first)];
  };
  if (value.quantity < Quantity::kRoll) return coordinate(Quantity::kX, X_WS.p);
  if (value.quantity < Quantity::kVx) return coordinate(Quantity::kRoll, ToRollPitchYaw(X_WS.q));
  const bool is_linear = value.quantity < Quantity::kWx;
  Vector3 v = is_linear ? PointVelocity(frame, robot, value.mount.link, X_WS.p)
                        : LinkTurn(frame, robot, value.mount.link);
  if (value.in_body) v = X_WS.q.conjugate() * v;
  return coordinate(is_linear ? Quantity::kVx : Quantity::kWx, v);
}

double Noise(const MappedNoise& noise, const NoiseKey& key) {
  switch (noise.kind) {
    case MappedNoise::Kind::kNone:
      return 0;
    case MappedNoise::Kind::kUniform:
      return noise.mean + noise.sigma * (2 * UniformNoise(key) - 1);
    case MappedNoise::Kind::kGaussian:
      return noise.mean + noise.sigma * GaussianNoise(key);
  }
  return 0;
}

/// Caches the last reading computed: values of one sensor are adjacent.
struct LastReading {
  std::size_t sensor = std::numeric_limits<std::size_t>::max();
  std::vector<double> values;
};

double ValueOf(const Frame& frame, int robot, const ChannelModel::Value& value, std::span<const double> cells,
               LastReading& last) {
  if (value.quantity == Quantity::kAmbientLight) return frame.scene->ambient_light;
  if (value.quantity > Quantity::kEnergy) return PlaceValue(frame, robot, value);
  if (value.quantity != Quantity::kReading) return JointValue(frame, robot, value, cells);
  if (last.sensor != value.source) {
    last.sensor = value.source;
    last.values.clear();
    const SensorKind& kind = ModelOf(frame, robot).sensors[value.source].kind;
    last.values.resize(FixedCount(kind));
    FillFixed(frame, robot, value.source, last.values);
  }
  return value.index < last.values.size() ? last.values[value.index] : kNoValue;
}

}  // namespace

std::vector<double> UnfilteredValues(const Frame& frame, int robot, std::size_t number) {
  std::vector<double> values;
  const RobotModel& robot_model = ModelOf(frame, robot);
  const auto* const model = robot_model.Find<ChannelModel>(number);
  if (model == nullptr) return values;
  LastReading last;
  NoiseKey key = KeyOf(frame, robot, NoiseKind::kChannelValue, number);
  const std::span<const double> cells = MeasuredOf(frame, robot, robot_model.IndexOf<ChannelModel>(number));
  values.reserve(model->values.size());
  for (std::size_t i = 0; i < model->values.size(); ++i) {
    const ChannelModel::Value& value = model->values[i];
    key.sample = static_cast<std::uint32_t>(i);
    const auto own = cells.empty() ? cells : cells.subspan(value.first_cell, value.cells());
    values.push_back(value.map.ToExternal(ValueOf(frame, robot, value, own, last)) + Noise(value.noise, key));
  }
  return values;
}

void AppendChannelValues(const Frame& frame, int robot, std::size_t number, std::vector<double>& data) {
  const RobotModel& robot_model = ModelOf(frame, robot);
  const auto* const model = robot_model.Find<ChannelModel>(number);
  if (model == nullptr) return;
  const std::vector<double> raw = UnfilteredValues(frame, robot, number);
  const std::span<const double> cells = MeasuredOf(frame, robot, robot_model.IndexOf<ChannelModel>(number));
  data.reserve(data.size() + model->values.size() + 2);
  for (std::size_t i = 0; i < model->values.size(); ++i) {
    const ChannelModel::Value& value = model->values[i];
    double external = raw[i];
    if (value.filter.cells() > 0) {
      // A recording without the filter's memory cannot reproduce its output.
      external = cells.empty() ? kNoValue : FilteredValue(value.filter, value.FilterCells(cells), external);
    }
    data.push_back(value.map.CutExternal(external));
  }
}

void CountTurns(const Frame& frame, int robot, const ChannelModel& model, std::span<double> cells) {
  for (const ChannelModel::Value& value : model.values) {
    if (!value.counts_turns) continue;
    const JointModel& joint = ModelOf(frame, robot).joints[value.source];
    double& turned_rad = cells[value.first_cell];
    turned_rad += WrapAngle(StateOf(frame, robot, joint).position - joint.start - turned_rad);
  }
}

bool IsAborted(const Frame& frame, int robot, std::size_t number) {
  const RobotModel& robot_model = ModelOf(frame, robot);
  const auto* const model = robot_model.Find<ChannelModel>(number);
  if (IsFrozen(frame, robot)) return true;
  if (model == nullptr) return false;
  for (const std::size_t sensor : model->aborts) {
    for (const double pressed : PressedZones(frame, robot, robot_model.NumberOf(sensor))) {
      if (pressed > 0) return true;
    }
  }
  return false;
}

std::vector<Setpoint> ChannelSetpoints(const Frame& frame, int robot, std::size_t number,
                                       std::span<const double> external) {
  const RobotModel& robot_model = ModelOf(frame, robot);
  std::vector<Setpoint> setpoints;
  std::vector<std::pair<const ActuatorModel*, int>> joints;
  for (const ActuatorModel& actuator : robot_model.actuators) {
    for (const int joint : actuator.joints) joints.emplace_back(&actuator, joint);
  }
  setpoints.assign(joints.size(), {0, ControlMode::kKeep});
  const auto* const model = robot_model.Find<ChannelModel>(number);
  if (model == nullptr) return setpoints;
  NoiseKey key = KeyOf(frame, robot, NoiseKind::kChannelMotor, number);
  for (std::size_t i = 0; i < std::min(model->motors.size(), external.size()); ++i) {
    const ChannelModel::Motor& motor = model->motors[i];
    if (motor.channel == ChannelModel::Motor::kNone) continue;
    key.sample = static_cast<std::uint32_t>(i);
    const double value = external[i] + Noise(motor.noise, key);
    const auto& [actuator, joint] = joints[motor.channel];
    Setpoint setpoint{motor.map.ToInternal(value), motor.mode};
    if (const auto* drive = std::get_if<DriveModel>(&actuator->kind)) {
      setpoint.reference =
          std::clamp(setpoint.reference, -drive->max_wheel_speed_rad_s, drive->max_wheel_speed_rad_s);
    } else {
      setpoint = Limit(robot_model.joints[static_cast<std::size_t>(joint)], setpoint);
    }
    setpoints[motor.channel] = setpoint;
  }
  return setpoints;
}

}  // namespace coopdyn

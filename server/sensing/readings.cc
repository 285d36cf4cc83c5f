// SPDX-License-Identifier: MIT
#include "server/sensing/readings.h"

#include <algorithm>
#include <cmath>

#include "server/base/portable_math.h"

namespace coopdyn {

namespace {

/// Sensor `number`, within its kind, of robot `robot` in `frame`.
struct Place {
  const Frame& frame;
  int robot;
  std::size_t number;
};

void AppendAll(const std::vector<Sighting>& seen, std::vector<double>& data) {
  for (const Sighting& one : seen) data.insert(data.end(), {one.distance_m, one.bearing_rad});
}

void Append(std::span<const double> values, std::vector<double>& data) {
  data.insert(data.end(), values.begin(), values.end());
}

// The table of sensors: one overload per kind.

void Append(const DistanceModel& /*model*/, const Place& at, std::vector<double>& data) {
  Append(Distances(at.frame, at.robot, at.number), data);
}
void Append(const TargetModel& /*model*/, const Place& at, std::vector<double>& data) {
  AppendAll(SeenTargets(at.frame, at.robot, at.number), data);
}
void Append(const PoseModel& model, const Place& at, std::vector<double>& data) {
  const PlaneMotion motion = MotionOf(at.frame, at.robot, model.link);
  data.insert(data.end(),
              {motion.x_m, motion.y_m, motion.heading_rad, motion.forward_m_s, motion.turn_rad_s});
}
void Append(const NeighboursModel& /*model*/, const Place& at, std::vector<double>& data) {
  AppendAll(Neighbours(at.frame, at.robot, at.number), data);
}
void Append(const CompassModel& /*model*/, const Place& at, std::vector<double>& data) {
  data.push_back(CompassHeading(at.frame, at.robot, at.number));
}
void Append(const SupportModel& /*model*/, const Place& at, std::vector<double>& data) {
  const SupportReading reading = Support(at.frame, at.robot, at.number);
  data.insert(data.end(), {reading.x_m, reading.y_m, reading.angle_rad});
}

void Append(const Vector3& v, std::vector<double>& data) {
  data.insert(data.end(), {v.x(), v.y(), v.z()});
}
void Append(const ImuModel& /*model*/, const Place& at, std::vector<double>& data) {
  const ImuReading reading = Imu(at.frame, at.robot, at.number).value_or(ImuReading());
  const Quaternion& q = reading.q_WS;
  data.insert(data.end(), {q.w(), q.x(), q.y(), q.z()});
  Append(reading.turn_S, data);
  Append(reading.acceleration_S, data);
}
void Append(const WrenchModel& /*model*/, const Place& at, std::vector<double>& data) {
  const WrenchReading reading = Wrench(at.frame, at.robot, at.number).value_or(WrenchReading());
  Append(reading.force_S, data);
  Append(reading.torque_S, data);
}
void Append(const LidarModel& /*model*/, const Place& at, std::vector<double>& data) {
  Append(Scan(at.frame, at.robot, at.number), data);
}
void Append(const SonarModel& /*model*/, const Place& at, std::vector<double>& data) {
  Append(SonarRanges(at.frame, at.robot, at.number), data);
}
void Append(const InfraredModel& /*model*/, const Place& at, std::vector<double>& data) {
  Append(InfraredValues(at.frame, at.robot, at.number), data);
}
void Append(const LightModel& /*model*/, const Place& at, std::vector<double>& data) {
  Append(LightValues(at.frame, at.robot, at.number), data);
}
void Append(const ContactModel& /*model*/, const Place& at, std::vector<double>& data) {
  for (const Touch& touch : Touches(at.frame, at.robot, at.number)) {
    data.push_back(touch.force_n);
    Append(touch.p_R, data);
    Append(touch.normal_R, data);
  }
}
void Append(const BatteryModel& /*model*/, const Place& at, std::vector<double>& data) {
  const BatteryReading reading = Battery(at.frame, at.robot, at.number);
  data.insert(data.end(), {reading.energy_j, reading.fraction, reading.power_w});
}
void Append(const OdometryModel& /*model*/, const Place& at, std::vector<double>& data) {
  const OdometryReading reading = Odometry(at.frame, at.robot, at.number);
  data.insert(data.end(),
              {reading.x_m, reading.y_m, reading.heading_rad, reading.forward_m_s, reading.turn_rad_s});
}
void Append(const CameraModel& model, const Place& at, std::vector<double>& data) {
  const RobotModel& robot = ModelOf(at.frame, at.robot);
  const double f = model.focal_px(),
               rate_hz = robot.sensors[robot.IndexOf<CameraModel>(at.number)].timing.rate_hz;
  data.insert(data.end(), {static_cast<double>(model.width), static_cast<double>(model.height), f, f,
                           model.width / 2.0, model.height / 2.0, model.near_m, model.far_m, rate_hz});
}
void Append(const ChannelModel& /*model*/, const Place& at, std::vector<double>& data) {
  AppendChannelValues(at.frame, at.robot, at.number, data);
}
template <typename Kind>
void Append(const Kind& /*model*/, const Place& /*at*/, std::vector<double>& /*data*/) {}

}  // namespace

void FillFixed(const Frame& frame, int robot, std::size_t sensor, std::span<double> values) {
  const RobotModel& model = ModelOf(frame, robot);
  std::vector<double> reading;
  if (std::holds_alternative<ContactModel>(model.sensors[sensor].kind)) {
    reading = PressedZones(SampleOf(frame, robot, sensor), robot, model.NumberOf(sensor));
  } else {
    AppendReading(frame, robot, sensor, reading);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = i < reading.size() ? reading[i] : std::numeric_limits<double>::quiet_NaN();
  }
}

void AppendReading(const Frame& frame, int robot, std::size_t sensor, std::vector<double>& data) {
  const RobotModel& model = ModelOf(frame, robot);
  if (sensor >= model.sensors.size()) return;
  const Place at{SampleOf(frame, robot, sensor), robot, model.NumberOf(sensor)};
  std::visit([&](const auto& kind) { Append(kind, at, data); }, model.sensors[sensor].kind);
}

Pose CarriedFrame(const Frame& frame, int robot, int link) {
  if (link == 0) return RobotPose(frame, robot);
  return LinkPose(frame, robot, link) *
         ModelOf(frame, robot).links[static_cast<std::size_t>(link)].X_RL.Inverse();
}

Twist OriginTwist(const Frame& frame, int robot, const Pose& X_WR, int link) {
  const SceneRobot& of = frame.scene->robots[static_cast<std::size_t>(robot)];
  const int index = of.first_body + (of.one_body() ? 0 : link);
  const BodyState& body = frame.bodies[static_cast<std::size_t>(index)];
  return {body.v_WB + body.w_WB.cross(X_WR.p - body.p_WB), body.w_WB};
}

PlaneMotion MotionOf(const Frame& frame, int robot, int link) {
  const Pose X_WR = CarriedFrame(frame, robot, link);
  const Twist twist = OriginTwist(frame, robot, X_WR, link);
  const double heading_rad = Heading(X_WR.q);
  const auto [sine, cosine] = portable::SinCos(heading_rad);
  return {X_WR.p.x(), X_WR.p.y(), heading_rad, twist.v_W.x() * cosine + twist.v_W.y() * sine, twist.w_W.z()};
}

}  // namespace coopdyn

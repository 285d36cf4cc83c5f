// SPDX-License-Identifier: MIT
#include "server/devices/sensor_devices.h"

#include "server/sensing/readings.h"

namespace coopdyn {

void AddSighting(Message& reply, std::uint32_t id, const std::string& word, const Sighting& sighting) {
  reply.params.push_back(static_cast<std::int32_t>(id));
  reply.text += (reply.text.empty() ? "" : " ") + word;
  reply.data.insert(reply.data.end(), {sighting.distance_m, sighting.bearing_rad});
}

void AddRobot(Message& reply, const Frame& frame, const Sighting& sighting) {
  const SceneRobot& other = frame.scene->robots[static_cast<std::size_t>(sighting.index)];
  AddSighting(reply, other.id.value, other.entry.name, sighting);
}

Message SensorDevice::Read(const Message& request, const Frame& frame, int robot) const {
  Message reply = ReplyTo(request.command);
  AppendFirstReading(frame, robot, reply.data);
  return reply;
}

void SensorDevice::AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const {
  AppendReading(frame, robot, sensor_, data);
}

Message DistanceDevice::Read(const Message& request, const Frame& frame, int robot) const {
  if (request.command != command::kGetGeometry) return SensorDevice::Read(request, frame, robot);
  Message reply = ReplyTo(request.command);
  const auto* model = ModelOf(frame, robot).Find<DistanceModel>(number());
  if (model == nullptr) return reply;
  reply.data.reserve(3 * model->sectors.size() + 2);
  for (const SectorModel& sector : model->sectors) {
    reply.data.insert(reply.data.end(), {sector.bearing_rad, sector.opening_rad, sector.max_range_m});
  }
  return reply;
}

Message PoseDevice::Read(const Message& request, const Frame& frame, int robot) const {
  if (request.command != command::kGetPose3d) return SensorDevice::Read(request, frame, robot);
  Message reply = ReplyTo(request.command);
  const Pose X_WR = RobotPose(frame, robot);
  const auto [v_W, w_W] = OriginTwist(frame, robot, X_WR);
  reply.data.reserve(15);
  reply.data = {X_WR.p.x(), X_WR.p.y(), X_WR.p.z(), X_WR.q.w(), X_WR.q.x(), X_WR.q.y(), X_WR.q.z(),
                v_W.x(),    v_W.y(),    v_W.z(),    w_W.x(),    w_W.y(),    w_W.z()};
  return reply;
}

}  // namespace coopdyn

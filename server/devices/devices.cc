// SPDX-License-Identifier: MIT
#include "server/devices/devices.h"

#include <algorithm>
#include <variant>

#include "protocol/module_tables.h"
#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

// Sensors whose modules have more than one command; other sensors need no entry.
template <typename Kind>
struct DeviceOf {
  using Type = SensorDevice;
};
template <>
struct DeviceOf<DistanceModel> {
  using Type = DistanceDevice;
};
template <>
struct DeviceOf<TargetModel> {
  using Type = TargetDevice;
};
template <>
struct DeviceOf<PoseModel> {
  using Type = PoseDevice;
};
template <>
struct DeviceOf<NeighboursModel> {
  using Type = NeighboursDevice;
};
template <>
struct DeviceOf<LidarModel> {
  using Type = LidarDevice;
};
template <>
struct DeviceOf<CameraModel> {
  using Type = CameraDevice;
};
template <>
struct DeviceOf<ContactModel> {
  using Type = ContactDevice;
};
template <>
struct DeviceOf<ChannelModel> {
  using Type = ChannelDevice;
};

/// 0 and "floor", or the id and name of an object or a robot.
std::pair<std::uint32_t, std::string> NameOf(const ContactEnd& end, const Scene& scene) {
  if (end.robot >= 0) {
    const SceneRobot& robot = scene.robots[static_cast<std::size_t>(end.robot)];
    return {robot.id.value, robot.entry.name};
  }
  if (end.object < 0) return {0, "floor"};
  const SceneObject& object = scene.objects[static_cast<std::size_t>(end.object)];
  return {object.id.value, object.object.name};
}

}  // namespace

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
  const auto* model = ModelOf(frame, robot).Find<PoseModel>(number());
  const int link = model == nullptr ? 0 : model->link;
  const Pose X_WR = CarriedFrame(frame, robot, link);
  const auto [v_W, w_W] = OriginTwist(frame, robot, X_WR, link);
  reply.data.reserve(15);
  reply.data = {X_WR.p.x(), X_WR.p.y(), X_WR.p.z(), X_WR.q.w(), X_WR.q.x(), X_WR.q.y(), X_WR.q.z(),
                v_W.x(),    v_W.y(),    v_W.z(),    w_W.x(),    w_W.y(),    w_W.z()};
  return reply;
}

Message LidarDevice::Read(const Message& request, const Frame& frame, int robot) const {
  if (request.command != command::kGetScanGeometry) return SensorDevice::Read(request, frame, robot);
  Message reply = ReplyTo(request.command);
  const auto* model = ModelOf(frame, robot).Find<LidarModel>(number());
  if (model == nullptr) return reply;
  const auto increment = [](double first, double last, int count) {
    return count > 1 ? (last - first) / (count - 1) : 0;
  };
  reply.data.reserve(10);
  reply.data = {model->first_azimuth_rad,
                increment(model->first_azimuth_rad, model->last_azimuth_rad, model->columns),
                model->min_range_m,
                model->max_range_m,
                static_cast<double>(model->rows),
                static_cast<double>(model->columns),
                model->first_elevation_rad,
                increment(model->first_elevation_rad, model->last_elevation_rad, model->rows)};
  return reply;
}

Message ContactDevice::Read(const Message& request, const Frame& frame, int robot) const {
  Message reply = ReplyTo(request.command);
  if (request.command == command::kGetBumper) {
    reply.data = PressedZones(frame, robot, number());
    return reply;
  }
  reply = SensorDevice::Read(request, frame, robot);
  for (const Touch& touch : Touches(frame, robot, number())) {
    const auto& [id, name] = NameOf(touch.other, *frame.scene);
    reply.params.push_back(static_cast<std::int32_t>(id));
    reply.text += (reply.text.empty() ? "" : " ") + name;
  }
  return reply;
}

std::unique_ptr<Device> MakeDevice(const RobotModel& model, std::string_view name) {
  if (name.empty()) return nullptr;
  for (std::size_t i = 0; i < model.actuators.size(); ++i) {
    const ActuatorModel& actuator = model.actuators[i];
    if (actuator.module != name) continue;
    const CommandTable& table = *FindModuleTable(actuator.type());
    if (actuator.is_board()) return std::make_unique<JointsDevice>(table, model, i);
    if (!actuator.is_drive()) return std::make_unique<ActuatorsDevice>(table, model, actuator);
    return std::make_unique<MotorsDevice>(table, std::get<DriveModel>(actuator.kind),
                                          model.FirstChannel(actuator));
  }
  for (std::size_t i = 0; i < model.sensors.size(); ++i) {
    if (model.sensors[i].name != name) continue;
    const auto make = [&]<typename Kind>(const Kind& /*kind*/) -> std::unique_ptr<Device> {
      return std::make_unique<typename DeviceOf<Kind>::Type>(*FindModuleTable(Kind::kType), model, i);
    };
    return std::visit(make, model.sensors[i].kind);
  }
  return nullptr;
}

Message NeighboursDevice::Read(const Message& request, const Frame& frame, int robot) const {
  Message reply = ReplyTo(request.command);
  if (request.command == command::kGetNeighbours) {
    for (const Sighting& sighting : Neighbours(frame, robot, number())) AddRobot(reply, frame, sighting);
  } else if (request.command == command::kGetMessages) {
    for (const HeardMessage& heard : HeardMessages(frame, robot, number())) {
      const RobotMessage& message = *heard.message;
      reply.params.push_back(
          static_cast<std::int32_t>(frame.scene->robots[static_cast<std::size_t>(heard.sender)].id.value));
      reply.params.push_back(static_cast<std::int32_t>(message.count));
      reply.data.insert(reply.data.end(), {heard.from.distance_m, heard.from.bearing_rad});
      reply.data.insert(reply.data.end(), message.values.begin(), message.values.begin() + message.count);
    }
  } else if (const auto* link = ModelOf(frame, robot).Find<NeighboursModel>(number())) {
    reply.data = {link->range_m, link->message_range_m, link->loss,
                  ToSeconds(link->delay_steps * frame.step_length)};
  }
  return reply;
}

std::optional<RobotMessage> NeighboursDevice::Broadcast(const Message& request) const {
  if (request.command != command::kSendMessage) return std::nullopt;
  RobotMessage message;
  message.count = static_cast<std::uint32_t>(request.data.size());
  std::copy(request.data.begin(), request.data.end(), message.values.begin());
  return message;
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include <algorithm>

#include "server/devices/sensor_devices.h"
#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

const SceneRobot& RobotAt(const Frame& frame, int index) {
  return frame.scene->robots[static_cast<std::size_t>(index)];
}

}  // namespace

Message NeighboursDevice::Read(const Message& request, const Frame& frame, int robot) const {
  Message reply = ReplyTo(request.command);
  if (request.command == command::kGetNeighbours) {
    for (const Sighting& sighting : Neighbours(frame, robot, number())) AddRobot(reply, frame, sighting);
  } else if (request.command == command::kGetMessages) {
    for (const HeardMessage& heard : HeardMessages(frame, robot, number())) {
      const RobotMessage& message = *heard.message;
      reply.params.push_back(static_cast<std::int32_t>(RobotAt(frame, heard.sender).id.value));
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

// SPDX-License-Identifier: MIT
#include "server/devices/neighbours.h"

#include <algorithm>

#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

const SceneRobot& RobotAt(const Frame& frame, int index) {
  return frame.scene->robots[static_cast<std::size_t>(index)];
}

Message ReadNeighbours(const Message& request, const Frame& frame, int robot) {
  Message reply = ReplyTo(request.command);
  for (const Sighting& sighting : Neighbours(frame, robot)) {
    const SceneRobot& other = RobotAt(frame, sighting.index);
    reply.params.push_back(static_cast<std::int32_t>(other.id.value));
    if (!reply.text.empty()) reply.text += ' ';
    reply.text += other.entry.name;
    reply.data.insert(reply.data.end(), {sighting.distance_m, sighting.bearing_rad});
  }
  return reply;
}

Message ReadMessages(const Message& request, const Frame& frame, int robot) {
  Message reply = ReplyTo(request.command);
  for (const HeardMessage& heard : HeardMessages(frame, robot)) {
    const RobotMessage& message = *heard.message;
    reply.params.push_back(static_cast<std::int32_t>(RobotAt(frame, heard.sender).id.value));
    reply.params.push_back(static_cast<std::int32_t>(message.count));
    reply.data.insert(reply.data.end(), {heard.from.distance_m, heard.from.bearing_rad});
    reply.data.insert(reply.data.end(), message.values.begin(), message.values.begin() + message.count);
  }
  return reply;
}

}  // namespace

void NeighboursDevice::AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const {
  for (const Sighting& sighting : Neighbours(frame, robot)) {
    data.insert(data.end(), {sighting.distance_m, sighting.bearing_rad});
  }
}

Message NeighboursDevice::Read(const Message& request, const Frame& frame, int robot) const {
  if (request.command == command::kGetNeighbours) return ReadNeighbours(request, frame, robot);
  if (request.command == command::kGetMessages) return ReadMessages(request, frame, robot);
  Message reply = ReplyTo(request.command);
  const NeighboursModel& link = model_->neighbours;
  reply.data = {link.range_m, link.message_range_m, link.loss,
                ToSeconds(link.delay_steps * frame.step_length)};
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

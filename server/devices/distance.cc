// SPDX-License-Identifier: MIT
#include "server/devices/distance.h"

#include <span>

#include "server/sensing/readings.h"

namespace coopdyn {

void DistanceDevice::AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const {
  const std::span<const double> ranges_m = Distances(frame, robot);
  data.insert(data.end(), ranges_m.begin(), ranges_m.end());
}

Message DistanceDevice::Read(const Message& request, const Frame& frame, int robot) const {
  Message reply = ReplyTo(request.command);
  if (request.command == command::kGetGeometry) {
    reply.data.reserve(3 * model_->distance_sensors.size() + 2);
    for (const DistanceSensorModel& sensor : model_->distance_sensors) {
      reply.data.insert(reply.data.end(), {sensor.bearing_rad, sensor.opening_rad, sensor.max_range_m});
    }
  } else {
    reply.data.reserve(model_->distance_sensors.size() + 2);
    AppendFirstReading(frame, robot, reply.data);
  }
  return reply;
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/devices/pose.h"

#include <cmath>

namespace coopdyn {

namespace {

/// Velocity of R's origin in W: that of the chassis' centre of mass, carried over by its rotation.
Vector3 OriginVelocity(const BodyState& chassis, const Pose& X_WR) {
  return chassis.v_WB + chassis.w_WB.cross(X_WR.p - chassis.p_WB);
}

const BodyState& ChassisOf(const Frame& frame, int robot) {
  return frame
      .bodies[static_cast<std::size_t>(frame.scene->robots[static_cast<std::size_t>(robot)].first_body)];
}

}  // namespace

void PoseDevice::AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const {
  const BodyState& chassis = ChassisOf(frame, robot);
  const Pose X_WR = RobotPose(frame, robot);
  const Vector3 v_WR = OriginVelocity(chassis, X_WR);
  const double heading_rad = Heading(X_WR.q);
  data.insert(data.end(),
              {X_WR.p.x(), X_WR.p.y(), heading_rad,
               v_WR.x() * std::cos(heading_rad) + v_WR.y() * std::sin(heading_rad), chassis.w_WB.z()});
}

Message PoseDevice::Read(const Message& request, const Frame& frame, int robot) const {
  Message reply = ReplyTo(request.command);
  if (request.command == command::kGetPose3d) {
    const BodyState& chassis = ChassisOf(frame, robot);
    const Pose X_WR = RobotPose(frame, robot);
    const Vector3 v_WR = OriginVelocity(chassis, X_WR);
    reply.data.reserve(15);
    reply.data = {X_WR.p.x(),       X_WR.p.y(),       X_WR.p.z(),      X_WR.q.w(), X_WR.q.x(),
                  X_WR.q.y(),       X_WR.q.z(),       v_WR.x(),        v_WR.y(),   v_WR.z(),
                  chassis.w_WB.x(), chassis.w_WB.y(), chassis.w_WB.z()};
  } else {
    reply.data.reserve(7);
    AppendFirstReading(frame, robot, reply.data);
  }
  return reply;
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Contact sensors: skins and bumpers.
#include <algorithm>
#include <cmath>

#include "server/base/portable_math.h"
#include "server/sensing/readings.h"

namespace coopdyn {

std::vector<Touch> Touches(const Frame& frame, int robot, std::size_t number) {
  std::vector<Touch> touches;
  const auto* model = ModelOf(frame, robot).Find<ContactModel>(number);
  if (model == nullptr) return touches;
  const Pose X_RW = RobotPose(frame, robot).Inverse();
  const auto is_felt = [&](const ContactEnd& end) {
    return end.robot == robot && std::ranges::any_of(model->parts, [&end](const ContactModel::Part& part) {
             return part.link == end.link && part.collision == static_cast<std::size_t>(end.collision);
           });
  };
  for (const Contact& contact : frame.contacts) {
    if (contact.a.robot != robot && contact.b.robot != robot) continue;
    const double force_n = contact.force_W.norm();
    const Vector3 p_R = X_RW * contact.p_W, normal_R = X_RW.q * contact.normal_W;
    // Two parts of one robot may touch each other; both feel the contact.
    if (is_felt(contact.a)) touches.push_back({contact.b, force_n, p_R, normal_R});
    if (is_felt(contact.b)) touches.push_back({contact.a, force_n, p_R, -normal_R});
  }
  return touches;
}

std::vector<double> PressedZones(const Frame& frame, int robot, std::size_t number) {
  const auto* model = ModelOf(frame, robot).Find<ContactModel>(number);
  if (model == nullptr) return {};
  const std::vector<Touch> touches = Touches(frame, robot, number);
  const auto force_n = [&touches](const auto& is_in) {
    double sum = 0;
    for (const Touch& touch : touches) sum += is_in(touch) ? touch.force_n : 0;
    return sum;
  };
  if (model->zones.empty())
    return {force_n([](const Touch&) { return true; }) > model->threshold_n ? 1.0 : 0.0};
  std::vector<double> pressed;
  for (const ContactModel::Zone& zone : model->zones) {
    const double sum_n = force_n([&zone](const Touch& touch) {
      const double bearing_rad = portable::Atan2(touch.p_R.y(), touch.p_R.x());
      return std::abs(WrapAngle(bearing_rad - zone.bearing_rad)) <= zone.opening_rad / 2;
    });
    pressed.push_back(sum_n > model->threshold_n ? 1.0 : 0.0);
  }
  return pressed;
}

}  // namespace coopdyn

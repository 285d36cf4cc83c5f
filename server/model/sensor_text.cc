// SPDX-License-Identifier: MIT
#include "server/model/sensor_text.h"

#include "server/model/values.h"

namespace coopdyn {

std::string Span(double min_m, double max_m) {
  return Rounded4(min_m) + " to " + Rounded4(max_m) + " m";
}
std::string On(const Mount& mount, const RobotModel& robot) {
  return "on " + robot.links[static_cast<std::size_t>(mount.link)].name;
}

std::string Describe(const SensorModel& sensor, const RobotModel& robot) {
  std::string text = std::visit(
      [&robot](const auto& one) -> std::string {
        if constexpr (requires { one.Text(robot); }) return one.Text(robot);
        return {};
      },
      sensor.kind);
  const auto add = [&text](const std::string& more) { text += (text.empty() ? "" : ", ") + more; };
  if (sensor.timing.rate_hz > 0) add(Rounded4(sensor.timing.rate_hz) + " Hz");
  if (sensor.timing.delay_s > 0) add(Rounded4(sensor.timing.delay_s) + " s late");
  return text;
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Sensors of light.
#include "server/model/sensor_models.h"

#include "server/model/sdf_sensors.h"
#include "server/model/values.h"

namespace coopdyn {

void LightModel::Read(const SensorSource& source) {
  constexpr double kAllRound_deg = 360;
  const double common_deg = source.attributes.Number("opening_deg", 0, kAllRound_deg).value_or(0);
  ReadNoise(source.attributes, "", noise);
  source.ForEachChild({"coopdyn:eye"}, [&](XmlAttributes& child, std::string_view) {
    Eye eye;
    eye.mount = source.ReadMount(child);
    eye.opening_rad = child.Number("opening_deg", 0, kAllRound_deg).value_or(common_deg) * kRadPerDeg;
    if (auto v = child.Flag("lamps")) eye.sees_lamps = *v;
    if (auto v = child.Numbers("color", 3)) {
      eye.color = Vector3((*v)[0], (*v)[1], (*v)[2]);
      if (eye.color->minCoeff() < 0 || eye.color->sum() <= 0)
        child.Error("color is red, green and blue: numbers from 0 on, not all 0");
      if (!eye.sees_lamps) child.Error("an eye with a color sees lamps alone: leave out lamps=\"false\"");
    }
    eyes.push_back(eye);
  });
  if (eyes.empty()) {
    source.attributes.Error(
        "write at least one <coopdyn:eye pose=\"x y z roll pitch yaw\" opening_deg=\"60\"/>; without an "
        "opening it sees all round");
  }
}

std::string LightModel::Text(const RobotModel& /*robot*/) const {
  return CountOf(eyes.size(), "eye");
}

}  // namespace coopdyn

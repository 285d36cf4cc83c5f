// SPDX-License-Identifier: MIT
#include <variant>

#include "protocol/module_tables.h"
#include "server/devices/motors.h"
#include "server/devices/sensor_devices.h"

namespace coopdyn {

namespace {

// The table of the sensors whose modules have more than one command; all others need no line.
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

}  // namespace

std::unique_ptr<Device> MakeDevice(const RobotModel& model, std::string_view name) {
  if (name.empty()) return nullptr;
  for (const ActuatorModel& actuator : model.actuators) {
    if (actuator.module != name) continue;
    return std::make_unique<MotorsDevice>(*FindModuleTable("motors"), std::get<DriveModel>(actuator.kind),
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

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// /R/distance: the distance sensors, right to left. Ranges in m from the chassis surface, inf = nothing in
// range; of the rays that sample a sector the smallest counts. Noise: Gaussian with the model's standard
// deviation, a function of (seed, sensor, step), so that reading twice gives the same. Constant; any thread.
#pragma once

#include <memory>

#include "server/devices/device.h"
#include "server/model/robot_model.h"

namespace coopdyn {

class DistanceDevice final : public Device {
 public:
  /// `table` outlives it.
  DistanceDevice(const CommandTable& table, std::shared_ptr<const RobotModel> model)
      : table_(table), model_(std::move(model)) {}

  const CommandTable& table() const override { return table_; }
  command::Id first_reading() const override { return command::kGetDistances; }
  Message Read(const Message& request, const Frame& frame, int robot) const override;
  void AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const override;

 private:
  const CommandTable& table_;
  const std::shared_ptr<const RobotModel> model_;
};

}  // namespace coopdyn

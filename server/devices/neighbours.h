// SPDX-License-Identifier: MIT
// /R/neighbours: where the robots nearby are, and short broadcasts to them. Distances in m between the
// robots' centres in the plane, bearings in rad, 0 ahead, left positive; seen and heard through obstacles.
// Noise, loss and delay are the model's, all a function of the seed (server/sensing). Constant; any thread.
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "server/devices/device.h"
#include "server/model/robot_model.h"

namespace coopdyn {

class NeighboursDevice final : public Device {
 public:
  /// `table` outlives it.
  NeighboursDevice(const CommandTable& table, std::shared_ptr<const RobotModel> model)
      : table_(table), model_(std::move(model)) {}

  const CommandTable& table() const override { return table_; }
  command::Id first_reading() const override { return command::kGetNeighbours; }
  Message Read(const Message& request, const Frame& frame, int robot) const override;
  void AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const override;
  std::optional<RobotMessage> Broadcast(const Message& request) const override;

 private:
  const CommandTable& table_;
  const std::shared_ptr<const RobotModel> model_;
};

}  // namespace coopdyn

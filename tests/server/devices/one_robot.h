// SPDX-License-Identifier: MIT
// A scene of one robot, and requests to its modules.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "server/devices/devices.h"
#include "server/state/frame.h"

namespace coopdyn {

inline std::shared_ptr<const Scene> SceneOf(std::shared_ptr<const RobotModel> model) {
  auto scenario = std::make_shared<Scenario>();
  scenario->robots.resize(1);
  scenario->robots[0].name = "rig";
  scenario->robots[0].model = std::move(model);
  return MakeScene(scenario);
}

inline Message Request(command::Id id, std::vector<std::int32_t> params, std::vector<double> data = {}) {
  Message request;
  request.command = id;
  request.params = std::move(params);
  request.data = std::move(data);
  return request;
}

}  // namespace coopdyn

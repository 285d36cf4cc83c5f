// SPDX-License-Identifier: MIT
// A robot's controller in the process where it runs, and the facts that it may point to during its lifetime.
// One thread at a time.
#pragma once

#include <string>
#include <vector>

#include "clients/plugin/controller.h"
#include "server/controllers/plugin.h"
#include "server/controllers/shared_area.h"

namespace coopdyn {

struct Instance {
  /// Copies the facts from the `in` area. `made_by` must outlive the instance.
  Instance(const Plugin& made_by, const RobotSetup& setup, const Areas& areas);
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  const Plugin* const plugin;
  void* state = nullptr;
  std::vector<coopdyn_joint> joints;
  std::vector<coopdyn_sensor_reading> sensed;  // by sensor; of the current step
  coopdyn_robot robot;

 private:
  std::string name_, joint_texts_, sensor_texts_, link_texts_, option_texts_;
  std::vector<double> bearing_rad_, opening_rad_, max_m_;
  std::vector<coopdyn_sensor> sensors_;
  std::vector<coopdyn_mapped> links_;
  std::vector<coopdyn_given> options_;
};

}  // namespace coopdyn

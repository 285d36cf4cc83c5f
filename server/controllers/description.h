// SPDX-License-Identifier: MIT
// What a controller says about itself, and the options of a scenario's controller line against that. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/model/scenario.h"

namespace coopdyn {

/// An option that a controller takes.
struct ControllerOption {
  std::string name, help;
  double value = 0, min = 0, max = 0;
};

/// What a controller says about itself.
struct ControllerDescription {
  std::string help;
  std::uint32_t readings = 0;  // of enum coopdyn_reading
  std::uint32_t state_size = 0;
  std::vector<ControllerOption> options;

  /// What is wrong with the options that a scenario gives, with what to write instead; one text each.
  std::vector<std::string> Faults(const ControllerChoice& choice) const;
  /// One value for each option: as given, else as described.
  std::vector<double> Values(const ControllerChoice& choice) const;
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// The world of `coopdyn bench swarm` and `recording`: robots at seeded positions in a walled square. Pure
// except for reading models.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "server/model/readers.h"

namespace coopdyn {

struct ArenaOptions {
  int robots = 1000;
  std::string robot = "minibot";
  std::optional<int> rays = std::nullopt;        // single rays instead of the model's sensors; 0: no sensors
  std::optional<double> range_m = std::nullopt;  // instead of the model's
  Fidelity fidelity = Fidelity::kRolling;
  std::string controller = {};  // `NAME option=value …`; empty: none
  double density_m2 = 1;        // robots per square metre between the walls
  int boxes = 0;                // of 0.5 kg, which the robots push
  std::uint64_t seed = 1;
  bool walls = true;     // round the robots
  double spacing_m = 0;  // least distance between robots' centres; 0: the swarm's default
};

/// A square of robots/density m² in free mode, with four static box walls if `walls`. Null on errors.
std::shared_ptr<const Scenario> MakeArena(const ArenaOptions& options, RobotLibrary& library,
                                          Diagnostics& diagnostics);

/// Four box walls of 0.1 m around a square of side `inner_m`, and the floor under them, as sections of a
/// scenario.
std::string WalledSquare(double inner_m, double height_m);

/// `model` with `rays` sensors of one ray each, evenly spread over the sector of the model's own sensors (all
/// round if they cover it), and with the range `range_m`. Omitted values stay unchanged. 0 rays remove the
/// distance module.
std::shared_ptr<const RobotModel> WithSensors(const RobotModel& model, std::optional<int> rays,
                                              std::optional<double> range_m);

}  // namespace coopdyn

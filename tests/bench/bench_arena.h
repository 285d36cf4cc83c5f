// SPDX-License-Identifier: MIT
// The world of `coopdyn bench swarm` and `recording`: robots at seeded places in a walled square. Pure but
// for reading models.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "server/model/readers.h"

namespace coopdyn {

struct ArenaOptions {
  int robots = 1000;
  std::string robot = "minibot";
  std::optional<int> rays =
      std::nullopt;  // instead of the model's sensors: single rays; 0: no sensors at all
  std::optional<double> range_m = std::nullopt;  // instead of the model's
  Fidelity fidelity = Fidelity::kRolling;
  std::string controller = {};  // `NAME option=value …`; empty: none
  double density_m2 = 1;        // robots per square metre between the walls
  int boxes = 0;                // of 0.5 kg among them, which robots push
  std::uint64_t seed = 1;
  bool walls = true;     // round the robots
  double spacing_m = 0;  // least distance between two robots' middles; 0: the swarm's default
};

/// A square of robots/density m², between four static box walls if there are any, in free mode. Null with
/// errors.
std::shared_ptr<const Scenario> MakeArena(const ArenaOptions& options, RobotLibrary& library,
                                          Diagnostics& diagnostics);

/// Four box walls of 0.1 m round a square of side `inner_m`, with the floor under them, as sections of a
/// scenario.
std::string WalledSquare(double inner_m, double height_m);

/// `model` with `rays` sensors of one ray each, evenly spread over the sector that its own ones cover, all
/// round if they do, and with the range `range_m`; what is not given stays. Without rays its distance module
/// goes.
std::shared_ptr<const RobotModel> WithSensors(const RobotModel& model, std::optional<int> rays,
                                              std::optional<double> range_m);

}  // namespace coopdyn

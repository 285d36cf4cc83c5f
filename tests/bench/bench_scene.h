// SPDX-License-Identifier: MIT
// Scenarios for the benchmarks: coopbots 2 m apart on a square, with a red target; swarms of minibots.
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

#include "server/model/readers.h"
#include "tests/source_dir.h"

namespace coopdyn {

inline std::string BenchScenarioText(int robots) {
  const int side = static_cast<int>(std::ceil(std::sqrt(robots)));
  std::string text = "[SIMULATION]\nmode lockstep\n[FLOOR]\nsize 100 100 0.1\n[TARGET]\nred 3 1 0.3\n";
  for (int i = 0; i < robots; ++i) {
    text += "[ROBOT_" + std::to_string(i + 1) + "]\ntype coopbot\nname robot" + std::to_string(i + 1) +
            "\nposition " + std::to_string(2 * (i % side)) + " " + std::to_string(2 * (i / side)) + "\n";
  }
  return text;
}

/// Returns `made`; on failure prints the errors and exits.
template <typename T>
std::shared_ptr<const T> OrExit(std::shared_ptr<const T> made, const Diagnostics& diagnostics) {
  if (made != nullptr) return made;
  std::fputs(diagnostics.ToString().c_str(), stderr);
  std::exit(1);
}

inline std::shared_ptr<const Scenario> BenchScenario(int robots) {
  RobotLibrary library(SearchPath{{SourceDir()}});
  Diagnostics diagnostics;
  return OrExit(ReadScenario(BenchScenarioText(robots), "bench.scenario", library, false, diagnostics),
                diagnostics);
}

/// A shipped robot.
inline std::shared_ptr<const RobotModel> BenchModel(const std::string& type) {
  RobotLibrary library(SearchPath{{SourceDir()}});
  Diagnostics diagnostics;
  return OrExit(library.Get(type, {}, diagnostics), diagnostics);
}

/// Robots on a square of 1 m² each, all headed along x.
inline std::shared_ptr<Scenario> SwarmScenario(std::shared_ptr<const RobotModel> model, Fidelity fidelity,
                                               int robots) {
  auto scenario = std::make_shared<Scenario>();
  const int side = static_cast<int>(std::ceil(std::sqrt(robots)));
  for (int i = 0; i < robots; ++i) {
    RobotEntry entry;
    entry.name = "robot" + std::to_string(i + 1);
    entry.model = model;
    entry.fidelity = fidelity;
    entry.X_WR.p = {1.0 * (i % side), 1.0 * (i / side), 0};
    scenario->robots.push_back(std::move(entry));
  }
  return scenario;
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// A scenario of N coopbots, 2 m apart on a square, with a red target, for the benchmarks.
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "server/model/readers.h"

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

inline std::shared_ptr<const Scenario> BenchScenario(int robots) {
  SearchPath path;
  path.folders.emplace_back(COOPDYN_SOURCE_DIR);
  RobotLibrary library(path);
  Diagnostics diagnostics;
  auto scenario = ReadScenario(BenchScenarioText(robots), "bench.scenario", library, false, diagnostics);
  if (scenario == nullptr) {
    std::fputs(diagnostics.ToString().c_str(), stderr);
    std::exit(1);
  }
  return scenario;
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Scenarios and worlds that a test writes as texts, and what the readers make of them. One thread.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "server/model/readers.h"
#include "tests/server/base/temp_folder.h"

namespace coopdyn {

/// The robots that ship with the sources; parsed once per test program.
inline RobotLibrary& ShippedRobots() {
  static RobotLibrary library(SearchPath{{COOPDYN_SOURCE_DIR}});
  return library;
}

/// What ReadScenario makes of `text`, called "test.scenario".
struct ReadResult {
  std::shared_ptr<const Scenario> scenario;
  std::string messages;
};
inline ReadResult Read(const std::string& text, bool by_socket = false) {
  Diagnostics diagnostics;
  auto scenario = ReadScenario(text, "test.scenario", ShippedRobots(), by_socket, diagnostics);
  return {scenario, diagnostics.ToString()};
}
/// The same for a .world, called "test.world".
struct WorldResult {
  WorldModel world;
  std::string messages;
};
inline WorldResult ReadWorldText(const std::string& text) {
  Diagnostics diagnostics;
  WorldModel world = ReadWorld(text, "test.world", diagnostics);
  return {std::move(world), diagnostics.ToString()};
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Scenarios and worlds that a test writes as texts, and the readers' results. One thread.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <utility>

#include "server/model/readers.h"
#include "tests/server/base/temp_folder.h"
#include "tests/source_dir.h"

namespace coopdyn {

/// The robots that ship with the sources; parsed once per test program.
inline RobotLibrary& ShippedRobots() {
  static RobotLibrary library(SearchPath{{SourceDir()}});
  return library;
}

/// The result of ReadScenario for `text`, called "test.scenario".
struct ReadResult {
  std::shared_ptr<const Scenario> scenario;
  std::string messages;
};
inline ReadResult Read(const std::string& text, bool by_socket = false) {
  Diagnostics diagnostics;
  auto scenario = ReadScenario(text, "test.scenario", ShippedRobots(), by_socket, diagnostics);
  return {scenario, diagnostics.ToString()};
}
/// The scenario of `text`, which must be valid.
inline std::shared_ptr<const Scenario> Good(const std::string& text) {
  const ReadResult result = Read(text);
  EXPECT_EQ(result.messages, "") << text;
  return result.scenario != nullptr ? result.scenario : std::make_shared<Scenario>();
}
/// The content of a file of the source tree, named from its root; must not be empty.
inline std::string FileText(const std::string& name) {
  std::ifstream stream(SourceDir() + "/" + name, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  EXPECT_FALSE(text.str().empty()) << name;
  return text.str();
}
/// The result of ReadWorld for `text`, called "test.world".
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

// SPDX-License-Identifier: MIT
// A folder of its own for a test, removed at the end. One thread.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "server/model/readers.h"

namespace coopdyn {

class TempFolder {
 public:
  TempFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "coopdyn-model-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TempFolder() { std::filesystem::remove_all(path_); }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  /// Writes `text` to `name` below the folder; returns its path.
  std::string Write(const std::string& name, const std::string& text) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file.string();
  }
  const std::filesystem::path& path() const { return path_; }

  /// `text` without this folder's path.
  std::string Strip(std::string text) const {
    const std::string prefix = path_.string() + "/";
    for (auto at = text.find(prefix); at != std::string::npos; at = text.find(prefix))
      text.erase(at, prefix.size());
    return text;
  }

 private:
  std::filesystem::path path_;
};

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

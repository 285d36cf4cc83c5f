// SPDX-License-Identifier: MIT
// SDF worlds as scenarios. One thread.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "server/model/readers.h"

namespace coopdyn {

/// A world as a scenario.
struct SdfWorld {
  std::string scenario;  // its text: what stands still and is simple becomes things, the rest robots
  std::map<std::string, std::shared_ptr<const RobotModel>>
      models;                                // of robots and things, by their names in the world
  std::map<std::string, SourceLine> places;  // where each robot and thing was written, by name
};

/// Whether `text` is one model, no world, as far as it can be read.
bool IsOneSdfModel(const std::string& text);

/// Reads the world in `file`. Nothing with errors.
std::optional<SdfWorld> ReadSdfWorld(const std::filesystem::path& file, const SearchPath& path,
                                     Diagnostics& diagnostics);

}  // namespace coopdyn

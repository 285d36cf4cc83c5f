// SPDX-License-Identifier: MIT
// Reads SDF worlds as scenarios. One thread.
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
  std::string scenario;  // its text: simple static models become things, all others robots
  std::map<std::string, std::shared_ptr<const RobotModel>>
      models;                                // of robots and things, by name in the world
  std::map<std::string, SourceLine> places;  // line of each robot and thing, by name
};

/// True if `text` is a single model, not a world, as far as it can be read.
bool IsOneSdfModel(const std::string& text);

/// Reads the world in `file`; nullopt if it has errors.
std::optional<SdfWorld> ReadSdfWorld(const std::filesystem::path& file, const SearchPath& path,
                                     Diagnostics& diagnostics);

}  // namespace coopdyn

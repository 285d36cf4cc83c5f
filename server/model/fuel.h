// SPDX-License-Identifier: MIT
// Addresses of models in Gazebo Fuel, and their folders in the cache of Gazebo's programs:
// CACHE/HOST/OWNER/models/NAME/VERSION. Downloads nothing. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace coopdyn {

struct FuelAddress {
  std::string url;             // of the model, without the file
  std::string owner, name;     // percent-decoded
  std::string version;         // empty: the newest
  std::filesystem::path file;  // in the model's folder; empty: the folder itself
};

/// Parses `https://fuel.gazebosim.org/1.0/OWNER/models/NAME[/VERSION][/files/FILE]` (also at
/// fuel.ignitionrobotics.org, and without the 1.0). Returns nullopt for any other `uri`.
std::optional<FuelAddress> FuelAddressOf(const std::string& uri);

/// The folder of that model in `cache`; owner and name are case-insensitive. Returns nullopt if it is
/// missing.
std::optional<std::filesystem::path> FuelFolderIn(const std::filesystem::path& cache,
                                                  const FuelAddress& address);

}  // namespace coopdyn

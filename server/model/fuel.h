// SPDX-License-Identifier: MIT
// Addresses of models in Gazebo's Fuel, and where its programs keep what they have fetched:
// CACHE/HOST/OWNER/models/NAME/VERSION. Nothing is fetched here. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace coopdyn {

struct FuelAddress {
  std::string url;             // of the model, without the file
  std::string owner, name;     // as they are written, without %20 and the like
  std::string version;         // empty: the newest
  std::filesystem::path file;  // in the model's folder; empty: the folder itself
};

/// What `https://fuel.gazebosim.org/1.0/OWNER/models/NAME[/VERSION][/files/FILE]` names (also at
/// fuel.ignitionrobotics.org, and without the 1.0); nothing if `uri` is no such address.
std::optional<FuelAddress> FuelAddressOf(const std::string& uri);

/// The folder of that model in `cache`, as owners and names are the same in lower case; nothing if it is not
/// there.
std::optional<std::filesystem::path> FuelFolderIn(const std::filesystem::path& cache,
                                                  const FuelAddress& address);

}  // namespace coopdyn

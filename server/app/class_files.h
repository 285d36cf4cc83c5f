// SPDX-License-Identifier: MIT
// The files of a class's folder: its list, the teacher's token. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "server/base/diagnostics.h"
#include "server/host/roll.h"
#include "server/net/unique_fd.h"

namespace coopdyn {

/// Random digits of the system.
RandomDigits SystemRandom();

/// FOLDER/class.csv.
std::filesystem::path RollFile(const std::filesystem::path& folder);
/// Nothing, and `diagnostics` say why: it cannot be read. `known`: as for ReadRoll().
std::optional<Roll> LoadRoll(const std::filesystem::path& file, Diagnostics& diagnostics,
                             const Roll& known = {});
/// Waits until nobody else changes the list of FOLDER. Held until it is destroyed.
UniqueFd LockRoll(const std::filesystem::path& folder);
/// Writes the list so that nobody reads half of it, and only its owner reads it at all. An error text.
std::string SaveRoll(const std::filesystem::path& file, const Roll& roll);

/// The teacher's token of FOLDER, which is made with the first call. Empty: `error` says why it cannot be
/// kept.
std::string TeacherToken(const std::filesystem::path& folder, std::string& error);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// The tables of a run file (docs/formats.md), and the rows that are not written step by step. One thread.
#pragma once

#include <cstdint>
#include <string>

#include "server/record/run_header.h"
#include "server/record/sqlite_db.h"
#include "server/state/scene.h"

namespace coopdyn {

/// Each returns false if the database refuses; its error() says why.
bool CreateTables(Database& database);
/// Tables meta and text, not yet sealed (run_seal.h). `closed` and `lost` are 0.
bool WriteHeader(Database& database, const RunHeader& header);
/// Tables scene, body, robot, target: the scene `number`, in force from `first_step` on; without its chain.
bool WriteScene(Database& database, std::int64_t number, std::uint64_t first_step, const Scene& scene);
bool SetMeta(Database& database, const std::string& key, std::int64_t value);
bool SetMetaText(Database& database, const std::string& key, const std::string& value);

/// What the bodies of `scene` are called: BOX_1; robot1.chassis, robot1.left_wheel; or, if all its links are
/// one body, robot1.
std::vector<std::string> BodyNames(const Scene& scene);

}  // namespace coopdyn

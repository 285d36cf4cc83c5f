// SPDX-License-Identifier: MIT
// The tables of a run file (docs/formats.md), and the rows that are not written step by step. All throw
// DatabaseError. One thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/record/run_header.h"
#include "server/record/sqlite_db.h"
#include "server/state/scene.h"

namespace coopdyn {

void CreateTables(Database& database);
/// Tables meta and text, not yet sealed (row_chain.h). `closed` and `lost` are 0.
void WriteHeader(const Database& database, const RunHeader& header);
/// The same read back: an error text that says what to do, empty if all is there.
std::string ReadHeader(const Database& database, RunHeader& header);
/// Tables scene, body, robot, channel, target: the scene `number`, in force from `first_step` on; without its
/// chain.
void WriteScene(const Database& database, std::int64_t number, std::uint64_t first_step, const Scene& scene);
/// `value`: a text or a whole number.
template <typename Value>
void SetMeta(const Database& database, std::string_view key, const Value& value) {
  database.Prepare("INSERT OR REPLACE INTO meta VALUES(?, ?)").Run(key, value);
}

/// What the bodies of `scene` are called: BOX_1; robot1.chassis, robot1.left_wheel; or, if all its links are
/// one body, robot1.
std::vector<std::string> BodyNames(const Scene& scene);
/// What a channel is called in tables: as its joint in the model.
const std::string& ChannelName(const Scene& scene, std::size_t channel);
/// The unit of its position, "rad"; its velocity's is the same with "_s".
std::string ChannelUnit(const Scene& scene, std::size_t channel);
/// The unit of a set-point of a channel with `unit`: "rad_s", "rad" or "nm".
std::string SetpointUnit(const std::string& unit, ControlMode mode);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// The tables of a run file (docs/formats.md) and the rows that are not written per step. All functions throw
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
/// Writes tables meta and text, not yet sealed (row_chain.h). `closed` and `lost` are 0.
void WriteHeader(const Database& database, const RunHeader& header);
/// Reads them back. Returns an error text that says what to do, empty on success.
std::string ReadHeader(const Database& database, RunHeader& header);
/// Writes scene `number`, in force from `first_step` on, to tables scene, body, robot, channel and target,
/// without its chain.
void WriteScene(const Database& database, std::int64_t number, std::uint64_t first_step, const Scene& scene);
/// `value`: a text or a whole number.
template <typename Value>
void SetMeta(const Database& database, std::string_view key, const Value& value) {
  database.Prepare("INSERT OR REPLACE INTO meta VALUES(?, ?)").Run(key, value);
}

/// Names of the bodies of `scene`: BOX_1; robot1.chassis, robot1.left_wheel; or robot1 if all its links are
/// one body.
std::vector<std::string> BodyNames(const Scene& scene);
/// A channel's name in tables: that of its joint in the model.
const std::string& ChannelName(const Scene& scene, std::size_t channel);
/// The unit of the channel's position, "rad" or "m"; "_s" appended gives the velocity's.
std::string ChannelUnit(const Scene& scene, std::size_t channel);
/// The unit of a set-point of a channel with `unit`: "rad_s", "rad", "nm", "n" or "duty".
std::string SetpointUnit(const std::string& unit, ControlMode mode);

}  // namespace coopdyn

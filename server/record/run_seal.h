// SPDX-License-Identifier: MIT
// What a run file says of its own tables, so that a change to any of them is found (docs/formats.md): where
// their chains end, and the seal of all that. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "server/record/row_chain.h"
#include "server/record/sqlite_db.h"

namespace coopdyn {

/// A table whose rows are chained, by increasing first column.
struct ChainedTable {
  const char* name;
  const char* columns;  // all but `chain`, in the order of the table
  int column_count;
  int step_column;
};
enum ChainedTableIndex { kSceneTable, kStepTable, kKeyframeTable, kInputTable, kEventTable };
inline constexpr std::array<ChainedTable, 5> kChainedTables{{
    {"scene", "id, first_step, description", 3, 1},
    {"step", "step, time_ns, hash, scene, commands, messages, wheels, distances, targets, poses", 10, 0},
    {"keyframe", "step, state", 2, 0},
    {"input", "id, step, action, detail", 4, 1},
    {"event", "id, step, time_ns, level, text", 5, 1},
}};

/// Where a table ends so far.
struct TableEnd {
  std::int64_t id = 0;  // first column of its last row
  RowChain chain;
};
using TableEnds = std::array<TableEnd, kChainedTables.size()>;

/// "step 1200 34" of kChainedTables[table]: its last row and the chain of that.
std::string EndText(std::size_t table, const TableEnd& end);
/// "scene 1 -12, step 1200 34, keyframe 1000 56, input 0 0, event 3 78": meta `ends`.
std::string EndsText(const TableEnds& ends);

/// Adds the rows of body, robot and target of scene `number`, as they stand in the file, to the row of that
/// scene in the making. Throws DatabaseError.
void AddSceneParts(Database& database, std::int64_t number, RowChain& chain);
/// Of table text: meta `texts`. Throws DatabaseError.
std::int32_t TextsChain(Database& database);
/// Of table meta but `seal`: meta `seal`. Throws DatabaseError.
std::int32_t SealOf(Database& database);
/// Whether meta has the seal that it ought to have. Throws DatabaseError.
bool IsSealed(Database& database);

// For those who write; false on error.
/// Writes the chain of scene `end.id` + 1, whose rows have been written, and goes on to it.
[[nodiscard]] bool LinkScene(Database& database, TableEnd& end);
/// Writes meta `texts`.
[[nodiscard]] bool SealTexts(Database& database);
/// Writes meta `seal`, after the last change of meta in a transaction.
[[nodiscard]] bool Seal(Database& database);

}  // namespace coopdyn

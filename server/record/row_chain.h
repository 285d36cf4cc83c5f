// SPDX-License-Identifier: MIT
// Makes changes to a run file detectable (docs/formats.md): each row of its tables has a chain, 32 bits of
// XXH3 over its columns and the chain of the previous row. Table meta holds the ends of the chains and a seal
// over meta. run_chain.h finds rows that were changed, removed, inserted or moved. One thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/record/sqlite_db.h"

namespace coopdyn {

/// Computes the chains of one table's rows.
class RowChain {
 public:
  /// Continues after a row with chain `value`; 0 starts a table.
  explicit RowChain(std::int32_t value = 0) { Restart(value); }
  void Restart(std::int32_t value);

  // The columns of a row, in order.
  void Add(std::int64_t value);
  void Add(std::string_view text);
  /// Empty bytes count as NULL, as Statement::Bind() writes them.
  void Add(std::span<const std::byte> bytes);
  /// Adds the first `count` columns of `row`, of any kind.
  void AddColumns(const Statement& row, int count);

  /// Ends the row and returns its chain.
  std::int32_t Link();
  /// The chain of the last row.
  std::int32_t value() const { return value_; }

 private:
  void Put(Statement::Kind kind, std::span<const std::byte> bytes);

  std::int32_t value_ = 0;
  std::vector<std::byte> bytes_;  // value_ and the columns of the current row
};

/// A table whose rows are chained in order of their first column.
struct ChainedTable {
  const char* name;
  const char* columns;  // all but `chain`, in the order of the table
  int step_column;
};
enum ChainedTableIndex { kSceneTable, kStepTable, kKeyframeTable, kInputTable, kEventTable };
inline constexpr std::array<ChainedTable, 5> kChainedTables{{
    {"scene", "id, first_step, description", 1},
    {"step", "step, time_ns, hash, scene, commands, messages, channels, distances, targets, poses, scores",
     0},
    {"keyframe", "step, state", 0},
    {"input", "id, step, action, detail", 1},
    {"event", "id, step, time_ns, level, text", 1},
}};

/// The current end of a table.
struct TableEnd {
  std::int64_t id = 0;  // first column of its last row
  RowChain chain;
};
using TableEnds = std::array<TableEnd, kChainedTables.size()>;

/// "step 1200 34": name, last row and its chain of kChainedTables[table].
std::string EndText(std::size_t table, const TableEnd& end);
/// "scene 1 -12, step 1200 34, keyframe 1000 56, input 0 0, event 3 78": meta `ends`.
std::string EndsText(const TableEnds& ends);

// All below throw DatabaseError.

/// Inserts a row with its chain after `end`; `columns` are std::int64_t, texts and bytes.
template <typename... Columns>
void InsertChained(Statement& insert, TableEnd& end, std::int64_t id, const Columns&... columns) {
  end.id = id;
  end.chain.Add(id);
  (end.chain.Add(columns), ...);
  insert.Run(id, columns..., end.chain.Link());
}
/// Adds the rows of tables body, robot, channel and target of scene `number`, as stored in the file, to the
/// current scene row of `chain`.
void AddSceneParts(const Database& database, std::int64_t number, RowChain& chain);
/// Writes the chain of scene `end.id` + 1, whose rows have been written, and advances `end` to it.
void LinkScene(const Database& database, TableEnd& end);

/// The chain over table text: meta `texts`.
std::int32_t TextsChain(const Database& database);
/// The chain over table meta without `seal`: meta `seal`.
std::int32_t SealOf(const Database& database);
/// Whether meta has the right seal.
bool IsSealed(const Database& database);
/// Writes meta `seal`, after the last change of meta in a transaction.
void Seal(const Database& database);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Was a recording changed after it was written? Goes along its chains, as far as it is asked to, and looks at
// its seal (docs/formats.md). What players and exports do without, since it reads every row. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "server/record/row_chain.h"

namespace coopdyn {

/// A row that is not as it was written, or not where.
struct ChainDamage {
  std::uint64_t step = 0;          // that the row belongs to
  std::string what, field;         // "the row of step 22", "event 3"; "chain", or "row" if it is missing
  std::string recorded, computed;  // values of `field`
};

class RunChain {
 public:
  /// Reads `file` on its own, as it stands. Null with `error` if it cannot, or has no chains.
  static std::unique_ptr<RunChain> Open(const std::string& file, std::string& error);

  /// Has chains, or cannot be read. Recordings of other programs have none.
  static bool IsChained(const std::string& file);

  /// Leaves out the steps and keyframes before the last keyframe up to `step`: whether those were changed is
  /// not read. Before all others. False, and error() says so, if it cannot be read there.
  bool SkipTo(std::uint64_t step);

  /// What of table meta and the texts was changed, for people: "its table meta was changed after it was
  /// written"; empty: nothing, or that it cannot be read (error()).
  std::string CheckHead();

  // The first damage among rows that were not checked before. If they cannot be read, nothing, and error()
  // says why.
  /// Steps up to `step`, and scenes, inputs and events that belong to them.
  std::optional<ChainDamage> CheckRows(std::uint64_t step);
  /// Keyframes up to `step`.
  std::optional<ChainDamage> CheckKeyframes(std::uint64_t step);
  /// CheckRows() up to the first step after `step`, which shows whether any before it are missing; if there
  /// is none, CheckRest(). `ends` as there, also if the walk does not come to that step.
  std::optional<ChainDamage> CheckRowsAround(std::uint64_t step, std::string& ends);
  /// All rows that are left. If nothing is wrong with them, `ends` says whether any are missing after the
  /// last: "its table event ends with row 3, where meta tells of another end"; empty: none are.
  std::optional<ChainDamage> CheckRest(std::string& ends);

  /// The first and the last step that were checked; −1: none was.
  std::int64_t first_step() const { return first_step_; }
  std::int64_t last_step() const { return first_step_ < 0 ? -1 : walks_[kStepTable].after; }

  const std::string& error() const { return error_; }

 private:
  struct Walk {
    Statement rows;               // after ?1, a few; their chain is in the last column
    std::int64_t after = kNone;   // first column of the row checked last
    RowChain chain;               // of that
    std::uint64_t waits_for = 0;  // the step of the next row
    TableEnd end() const { return {after == kNone ? 0 : after, chain}; }
  };
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::min();

  RunChain() = default;
  /// What `read()` gives; nothing, and error() says so, if the file cannot be read.
  template <typename Read>
  auto Guard(Read read) -> decltype(read());
  void Prepare();
  std::optional<ChainDamage> Go(ChainedTableIndex table, std::uint64_t step);
  /// The row that the walk of `table` stands at.
  std::optional<ChainDamage> CheckRow(ChainedTableIndex table);
  /// What CheckRest() says of them.
  std::string CompareEnds() const;
  void FailReading(const DatabaseError& failed, const std::string& where);

  std::unique_ptr<Database> database_;  // goes after the statements
  std::array<Walk, kChainedTables.size()> walks_;
  std::int64_t first_step_ = -1;
  std::string error_;
};

}  // namespace coopdyn

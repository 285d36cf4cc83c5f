// SPDX-License-Identifier: MIT
// Finds out whether a recording was changed after it was written, from its chains and its seal
// (docs/formats.md). Players and exports do not use it because it reads every row. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "server/record/row_chain.h"

namespace coopdyn {

/// A row that was changed or moved after it was written.
struct ChainDamage {
  std::uint64_t step = 0;          // the step that the row belongs to
  std::string what, field;         // "the row of step 22", "event 3"; "chain", or "row" if missing
  std::string recorded, computed;  // values of `field`
};

class RunChain {
 public:
  /// Opens `file` on its own connection, without mending it. Null with `error` if the file cannot be read or
  /// has no chains.
  static std::unique_ptr<RunChain> Open(const std::string& file, std::string& error);

  /// True if `file` has chains or cannot be read. Recordings made by other programs have none.
  static bool IsChained(const std::string& file);

  /// Skips the steps and keyframes before the last keyframe at or before `step`: they are not checked. Call
  /// it before all other checks. False, with error() set, if the file cannot be read there.
  bool SkipTo(std::uint64_t step);

  /// Checks table meta and the texts. Returns a message such as "its table meta was changed after it was
  /// written"; empty if they are unchanged or cannot be read (error()).
  std::string CheckHead();

  // All below return the first damage among rows not checked before. If the rows cannot be read, they return
  // nullopt and error() says why.
  /// Checks the steps up to `step` and the scenes, inputs and events that belong to them.
  std::optional<ChainDamage> CheckRows(std::uint64_t step);
  /// Checks the keyframes up to `step`.
  std::optional<ChainDamage> CheckKeyframes(std::uint64_t step);
  /// Calls CheckRows() up to the first step after `step`, which shows whether any before it are missing;
  /// without such a step, CheckRest(). Sets `ends` as CheckRest() does, also if the walk does not reach that
  /// step.
  std::optional<ChainDamage> CheckRowsAround(std::uint64_t step, std::string& ends);
  /// Checks all remaining rows. If they are intact, `ends` says whether rows are missing after the last: "its
  /// table event ends with row 3, where meta tells of another end"; empty if none are.
  std::optional<ChainDamage> CheckRest(std::string& ends);

  /// The first and the last checked step; −1 before any.
  std::int64_t first_step() const { return first_step_; }
  std::int64_t last_step() const { return first_step_ < 0 ? -1 : walks_[kStepTable].after; }

  const std::string& error() const { return error_; }

 private:
  struct Walk {
    Statement rows;               // the next rows after ?1; the last column is their chain
    std::int64_t after = kNone;   // first column of the last checked row
    RowChain chain;               // of the last checked row
    std::uint64_t waits_for = 0;  // the step of the next row
    TableEnd end() const { return {after == kNone ? 0 : after, chain}; }
  };
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::min();

  RunChain() = default;
  /// Returns `read()`; an empty value, with error() set, if the file cannot be read.
  template <typename Read>
  auto Guard(Read read) -> decltype(read());
  void Prepare();
  std::optional<ChainDamage> Go(ChainedTableIndex table, std::uint64_t step);
  /// Checks the current row of the walk of `table`.
  std::optional<ChainDamage> CheckRow(ChainedTableIndex table);
  /// Compares the walks' ends with meta; returns `ends` of CheckRest().
  std::string CompareEnds() const;
  void FailReading(const DatabaseError& failed, const std::string& where);

  std::unique_ptr<Database> database_;  // declared first: outlives the statements
  std::array<Walk, kChainedTables.size()> walks_;
  std::int64_t first_step_ = -1;
  std::string error_;
};

}  // namespace coopdyn

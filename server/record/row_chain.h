// SPDX-License-Identifier: MIT
// The chain of a table of a run file: each row has 32 bits of XXH3 over its columns and the chain of the row
// before it, so that rows that were changed, taken out, put in or moved are found (docs/formats.md). Not
// thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "server/record/sqlite_db.h"

namespace coopdyn {

class RowChain {
 public:
  /// Goes on from a row of chain `value`; 0: from the start of a table.
  explicit RowChain(std::int32_t value = 0) { Restart(value); }
  void Restart(std::int32_t value);

  // The columns of a row, in order.
  void Null();
  void Integer(std::int64_t value);
  void Text(std::string_view text);
  /// No bytes at all are NULL, as Statement::BindBlob() writes them.
  void Blob(std::span<const std::byte> bytes);
  /// Columns first … first + count − 1 of `row`, of whatever kind they are.
  void Columns(const Statement& row, int first, int count);

  /// Ends the row, and gives its chain.
  std::int32_t Link();
  /// Of the last row.
  std::int32_t value() const { return value_; }

 private:
  void Put(Statement::Kind kind, std::span<const std::byte> bytes);

  std::int32_t value_ = 0;
  std::vector<std::byte> bytes_;  // of the row in the making, after value_
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Chains and seal of a run file, computed from docs/formats.md alone, without the code that writes and checks
// them, like another tool would. One thread.
#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace coopdyn {

class Rechainer {
 public:
  explicit Rechainer(const std::string& file) {
    EXPECT_EQ(sqlite3_open_v2(file.c_str(), &database_, SQLITE_OPEN_READWRITE, nullptr), SQLITE_OK);
  }
  ~Rechainer() { sqlite3_close(database_); }
  Rechainer(const Rechainer&) = delete;
  Rechainer& operator=(const Rechainer&) = delete;

  void All() {
    std::string ends;
    for (const char* table : {"scene", "step", "keyframe", "input", "event"}) {
      ends += (ends.empty() ? "" : ", ") + Table(table);
    }
    Run("UPDATE meta SET value = " + Number(Texts()) + " WHERE key = 'texts'");
    Run("UPDATE meta SET value = '" + ends + "' WHERE key = 'ends'");
    Seal();
  }
  void Seal() {
    std::uint32_t chain = 0;
    Each("SELECT key, value FROM meta WHERE key <> 'seal' ORDER BY key",
         [&](sqlite3_stmt* row) { chain = Chained(chain, Row(row, 2)); });
    Run("UPDATE meta SET value = " + Number(chain) + " WHERE key = 'seal'");
  }
  /// All chains and meta's values of them, for comparison.
  std::string Dump() {
    std::string dump;
    for (const std::string table : {"scene", "step", "keyframe", "input", "event"}) {
      Each("SELECT rowid, chain FROM " + table + " ORDER BY rowid",
           [&](sqlite3_stmt* row) { dump += table + " " + Text(row, 0) + " " + Text(row, 1) + "\n"; });
    }
    Each("SELECT key, value FROM meta WHERE key IN ('texts', 'ends', 'seal') ORDER BY key",
         [&](sqlite3_stmt* row) { dump += Text(row, 0) + " " + Text(row, 1) + "\n"; });
    return dump;
  }

 private:
  static std::string Text(sqlite3_stmt* row, int column) {
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
    return text == nullptr ? "NULL" : text;
  }
  /// As a signed integer, as in SQLite.
  static std::string Number(std::uint32_t chain) { return std::to_string(static_cast<std::int32_t>(chain)); }
  static std::uint32_t Chained(std::uint32_t before, const std::string& row) {
    const std::string bytes = Little(before, 4) + row;
    return static_cast<std::uint32_t>(XXH3_64bits(bytes.data(), bytes.size()));
  }
  static std::string Little(std::uint64_t number, int count) {
    std::string bytes;
    for (int i = 0; i < count; ++i) bytes += static_cast<char>(number >> (8 * i) & 0xff);
    return bytes;
  }
  static std::string Row(sqlite3_stmt* row, int columns) {
    std::string bytes;
    for (int i = 0; i < columns; ++i) {
      const int type = sqlite3_column_type(row, i);
      if (type == SQLITE_NULL) bytes += '\0';
      if (type == SQLITE_INTEGER) {
        bytes += '\1' + Little(static_cast<std::uint64_t>(sqlite3_column_int64(row, i)), 8);
      }
      if (type == SQLITE_FLOAT) {
        const double value = sqlite3_column_double(row, i);
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, 8);
        bytes += '\2' + Little(bits, 8);
      }
      if (type == SQLITE_TEXT || type == SQLITE_BLOB) {
        bytes += type == SQLITE_TEXT ? '\3' : '\4';
        const auto* begin = static_cast<const char*>(sqlite3_column_blob(row, i));
        const auto size = static_cast<std::size_t>(sqlite3_column_bytes(row, i));
        bytes += Little(size, 4) + std::string(begin == nullptr ? "" : begin, begin == nullptr ? 0 : size);
      }
    }
    return bytes;
  }
  void Run(const std::string& sql) {
    EXPECT_EQ(sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database_);
  }
  void Each(const std::string& sql, const std::function<void(sqlite3_stmt*)>& use) {
    sqlite3_stmt* statement = nullptr;
    ASSERT_EQ(sqlite3_prepare_v2(database_, sql.c_str(), -1, &statement, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database_);
    while (sqlite3_step(statement) == SQLITE_ROW) use(statement);
    sqlite3_finalize(statement);
  }
  std::uint32_t Texts() {
    std::uint32_t chain = 0;
    Each("SELECT kind, name, file, content FROM text ORDER BY kind, name",
         [&](sqlite3_stmt* row) { chain = Chained(chain, Row(row, 4)); });
    return chain;
  }
  /// The end of a table's chain, for meta.
  std::string Table(const std::string& table) {
    std::vector<std::pair<std::string, std::uint32_t>> chains;  // by row
    std::uint32_t chain = 0;
    // All columns except the last, `chain`.
    Each("SELECT * FROM " + table + " ORDER BY rowid", [&](sqlite3_stmt* row) {
      std::string bytes = Row(row, sqlite3_column_count(row) - 1);
      const std::string id = Text(row, 0);
      for (const std::string part : {"body", "robot", "channel", "target"}) {
        if (table != "scene") break;
        Each("SELECT * FROM " + part + " WHERE scene = " + id + " ORDER BY place",
             [&](sqlite3_stmt* thing) { bytes += Row(thing, sqlite3_column_count(thing)); });
      }
      chain = Chained(chain, bytes);
      chains.emplace_back(id, chain);
    });
    for (const auto& [id, value] : chains) {
      Run("UPDATE " + table + " SET chain = " + Number(value) + " WHERE rowid = " + id);
    }
    return table + " " + (chains.empty() ? "0" : chains.back().first) + " " + Number(chain);
  }

  sqlite3* database_ = nullptr;
};

/// Recomputes all chains of a changed `file`, as if it had been recorded like that.
inline void Rechain(const std::string& file) {
  Rechainer(file).All();
}

}  // namespace coopdyn

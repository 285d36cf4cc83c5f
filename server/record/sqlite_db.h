// SPDX-License-Identifier: MIT
// RAII wrappers of SQLite: a database and its prepared statements. Failures throw DatabaseError, so that no
// error is mistaken for the end of the rows; callers must not let it escape their thread. One thread at a
// time.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

struct sqlite3;
struct sqlite3_stmt;

namespace coopdyn {

/// what() is "lesson1.run: disk I/O error (File too large)".
class DatabaseError final : public std::runtime_error {
 public:
  /// `code`: SQLite's primary result code; `reason`: errno, 0 if none.
  explicit DatabaseError(const std::string& text, int code = 0, int reason = 0)
      : std::runtime_error(text), code_(code), reason_(reason) {}

  int code() const { return code_; }
  /// Another program has locked the database.
  bool busy() const;
  /// The file is no database, is damaged, or cannot be read from its disk.
  bool damaged() const;
  /// The disk is full, or a quota or file size limit is reached.
  bool full() const;

 private:
  int code_, reason_;
};

class Database;

/// A prepared statement. Its database must outlive it. Parameters count from 1 and columns from 0, as in
/// SQLite.
class Statement {
 public:
  enum class Kind : std::uint8_t { kNull, kInteger, kReal, kText, kBlob };

  /// No statement: can only be assigned to.
  Statement() = default;

  /// Clamps to SQLite's greatest integer.
  template <std::integral Integer>
  void Bind(int parameter, Integer value) {
    constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
    BindInteger(parameter, std::cmp_less(value, kMost) ? static_cast<std::int64_t>(value) : kMost);
  }
  void Bind(int parameter, double value);
  /// Text and bytes are not copied: they must stay unchanged until Reset() or the next Bind().
  void Bind(int parameter, std::string_view text);
  /// Empty bytes bind NULL.
  void Bind(int parameter, std::span<const std::byte> bytes);
  void BindNull(int parameter);
  /// Nullopt binds NULL.
  template <typename Value>
  void Bind(int parameter, const std::optional<Value>& value) {
    value ? Bind(parameter, *value) : BindNull(parameter);
  }

  /// Binds the first parameters.
  template <typename... Values>
  void BindAll(const Values&... values) {
    int parameter = 0;
    (Bind(++parameter, values), ...);
  }

  /// Advances to the next row. After the last row, resets the statement and returns false.
  [[nodiscard]] bool Step();
  /// Binds the first parameters, steps to the end and resets.
  template <typename... Values>
  void Run(const Values&... values) {
    BindAll(values...);
    while (Step()) {
    }
  }
  /// Prepares for another run. Parameters stay bound.
  void Reset();

  int columns() const;
  Kind kind(int column) const;
  bool is_null(int column) const { return kind(column) == Kind::kNull; }
  bool is_integer(int column) const { return kind(column) == Kind::kInteger; }
  std::int64_t integer(int column) const;
  double real(int column) const;
  std::string text(int column) const;
  /// Valid until the next Step() or Reset(). Empty for NULL; the bytes of a text.
  std::span<const std::byte> blob(int column) const;

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  void BindInteger(int parameter, std::int64_t value);

  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  const Database* database_ = nullptr;  // that prepared it
};

class Database {
 public:
  enum class Access { kReadOnly, kReadWrite, kCreate };

  /// Null with `error` ("lesson1.run: unable to open database file (Permission denied)") if the file cannot
  /// be opened. Does not read the file: a file that is no database fails at the first statement. Nothing in a
  /// file is trusted: its schema can call no function with side effects. Waits up to two seconds for other
  /// processes' locks.
  static std::unique_ptr<Database> Open(const std::string& file, Access access, std::string& error);

  const std::string& file() const { return file_; }
  Statement Prepare(std::string_view sql) const;
  /// Runs statements, separated by semicolons, and drops their rows.
  void Run(const std::string& sql);
  /// Like Run(), but returns false with error() set if it fails.
  bool Try(const std::string& sql);
  /// The first column of the first row of `sql` with `values` as parameters; nullopt if there is no row or it
  /// is NULL.
  template <typename... Values>
  std::optional<std::int64_t> Integer(std::string_view sql, const Values&... values) const {
    Statement row = Prepare(sql);
    row.BindAll(values...);
    return row.Step() && !row.is_null(0) ? std::optional(row.integer(0)) : std::nullopt;
  }
  template <typename... Values>
  std::optional<std::string> Text(std::string_view sql, const Values&... values) const {
    Statement row = Prepare(sql);
    row.BindAll(values...);
    return row.Step() && !row.is_null(0) ? std::optional(row.text(0)) : std::nullopt;
  }
  /// Rolls back the current transaction, if any: when the disk is full, SQLite has already rolled back.
  void RollBack();
  /// Merges the log beside the file into the file. Throws if another connection has the file open.
  void MakePlain();
  /// The error of the last failed call.
  DatabaseError last_error() const;
  std::string error() const { return last_error().what(); }

 private:
  struct Close {
    void operator()(sqlite3* database) const;
  };
  Database(std::string file, sqlite3* database) : file_(std::move(file)), database_(database) {}

  const std::string file_;
  const std::unique_ptr<sqlite3, Close> database_;
};

}  // namespace coopdyn

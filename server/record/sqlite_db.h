// SPDX-License-Identifier: MIT
// SQLite with owners instead of handles: a database and its prepared statements. What fails throws
// DatabaseError, so that no error is taken for the end of the rows; those who use this let it cross no
// thread. One thread at a time.
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
  /// `code`: SQLite's primary one; `reason`: errno of the system, 0: none.
  explicit DatabaseError(const std::string& text, int code = 0, int reason = 0)
      : std::runtime_error(text), code_(code), reason_(reason) {}

  int code() const { return code_; }
  /// Other programs hold the database.
  bool busy() const;
  /// It is no database, a damaged one, or its disk cannot be read.
  bool damaged() const;
  /// There is no room: the disk, a quota, or a limit on the size of files.
  bool full() const;

 private:
  int code_, reason_;
};

class Database;

/// A prepared statement. Its database lives longer. Parameters count from 1, columns from 0, as in SQL.
class Statement {
 public:
  enum class Kind : std::uint8_t { kNull, kInteger, kReal, kText, kBlob };

  /// Is none: only to be assigned to.
  Statement() = default;

  /// The greatest number that SQLite has stands for those beyond it.
  template <std::integral Integer>
  void Bind(int parameter, Integer value) {
    constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
    BindInteger(parameter, std::cmp_less(value, kMost) ? static_cast<std::int64_t>(value) : kMost);
  }
  void Bind(int parameter, double value);
  /// Text and bytes are not copied: they stay as they are until Reset() or the next Bind().
  void Bind(int parameter, std::string_view text);
  /// No bytes at all are NULL.
  void Bind(int parameter, std::span<const std::byte> bytes);
  void BindNull(int parameter);
  /// Nothing is NULL.
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

  /// Goes on to the next row. False: there is none, and the statement is reset.
  [[nodiscard]] bool Step();
  /// Binds the first parameters, steps to the end, and resets.
  template <typename... Values>
  void Run(const Values&... values) {
    BindAll(values...);
    while (Step()) {
    }
  }
  /// Ready for new parameters and another run. What was bound stays bound.
  void Reset();

  int columns() const;
  Kind kind(int column) const;
  bool is_null(int column) const { return kind(column) == Kind::kNull; }
  bool is_integer(int column) const { return kind(column) == Kind::kInteger; }
  std::int64_t integer(int column) const;
  double real(int column) const;
  std::string text(int column) const;
  /// Valid until the next Step() or Reset(). Empty for NULL; of a text its bytes.
  std::span<const std::byte> blob(int column) const;

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  void BindInteger(int parameter, std::int64_t value);

  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  const Database* database_ = nullptr;  // where it was prepared
};

class Database {
 public:
  enum class Access { kReadOnly, kReadWrite, kCreate };

  /// Null with `error` ("lesson1.run: unable to open database file (Permission denied)") if it cannot be
  /// opened. The file is not looked into: what is no database shows at the first statement. Nothing in a
  /// file is trusted: its schema can call no function with side effects. Waits up to two seconds for locks of
  /// other processes.
  static std::unique_ptr<Database> Open(const std::string& file, Access access, std::string& error);

  const std::string& file() const { return file_; }
  Statement Prepare(std::string_view sql) const;
  /// Runs statements, separated by semicolons, and drops their rows.
  void Run(const std::string& sql);
  /// The same; false, and error() says why, if it fails.
  bool Try(const std::string& sql);
  /// The first column of the first row of `sql` with `values` as parameters; nothing if there is none, or it
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
  /// Ends the present transaction, if there is one: SQLite ends it itself when the disk is full.
  void RollBack();
  /// Makes a log that lies beside the file part of it, if nobody else has it open: then all is in one file.
  void MakePlain();
  /// Of the last call that failed.
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

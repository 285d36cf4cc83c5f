// SPDX-License-Identifier: MIT
// SQLite with owners instead of handles: a database and its prepared statements. What reads throws, so that
// no error can be taken for the end of the rows; what writes returns false, and nobody may ignore it. One
// thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
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

class Database;

/// SQLite could not read: what() is as Database::error() says it.
class DatabaseError final : public std::runtime_error {
 public:
  DatabaseError(const std::string& text, bool busy) : std::runtime_error(text), busy_(busy) {}
  /// Others hold the database.
  bool busy() const { return busy_; }

 private:
  bool busy_;
};

/// A prepared statement. Its database lives longer. Parameters count from 1, columns from 0, as in SQL.
class Statement {
 public:
  enum class Kind : std::uint8_t { kNull, kInteger, kReal, kText, kBlob };

  Statement() = default;
  Statement(Statement&& other) noexcept;
  Statement& operator=(Statement&& other) noexcept;
  ~Statement();

  /// False: it could not be prepared; Database::error() says why.
  explicit operator bool() const { return statement_ != nullptr; }

  void Bind(int parameter, std::int64_t value);
  void Bind(int parameter, double value);
  void BindNull(int parameter);
  /// Text and bytes are not copied: they stay as they are until Reset() or the next Bind().
  void BindText(int parameter, std::string_view text);
  /// No bytes at all are NULL.
  void BindBlob(int parameter, std::span<const std::byte> bytes);

  /// Goes on to the next row. False: there is none, and the statement is reset. Throws DatabaseError, also if
  /// it could not be prepared.
  [[nodiscard]] bool Step();
  /// Steps to the end of a statement without rows, and resets it; false on error.
  [[nodiscard]] bool Run();
  /// Ready for new parameters and another run. What was bound stays bound.
  void Reset();

  Kind kind(int column) const;
  bool is_null(int column) const;
  bool is_integer(int column) const;
  std::int64_t integer(int column) const;
  double real(int column) const;
  std::string text(int column) const;
  /// Valid until the next Step() or Reset(). Empty for NULL; of a text its bytes.
  std::span<const std::byte> blob(int column) const;

 private:
  friend class Database;
  Statement(sqlite3_stmt* statement, const Database& database)
      : statement_(statement), database_(&database) {}

  sqlite3_stmt* statement_ = nullptr;
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
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  const std::string& file() const { return file_; }
  /// Empty with error() if `sql` cannot be prepared.
  Statement Prepare(std::string_view sql);
  /// Runs statements, separated by semicolons, and drops their rows; false on error.
  bool Run(const std::string& sql);
  /// The first column of the first row; nothing if there is none, or it is NULL. Throws DatabaseError.
  std::optional<std::int64_t> Integer(std::string_view sql);
  std::optional<std::string> Text(std::string_view sql);
  /// Makes a log that lies beside the file part of it, if nobody else has it open: then all is in one file.
  [[nodiscard]] bool MakePlain();
  /// A transaction has begun and not ended; SQLite ends one itself when the disk is full.
  bool in_transaction() const;

  /// Of the last call that failed: "lesson1.run: disk I/O error (File too large)".
  std::string error() const;
  /// SQLite's primary code of it, e.g. SQLITE_BUSY; 0: none.
  int error_code() const;
  /// It failed since others hold the database: error_code() is SQLITE_BUSY or SQLITE_LOCKED.
  bool busy() const;
  /// It failed since the file is no database, a damaged one, or its disk cannot be read.
  bool damaged() const;
  /// The last call that failed found no room: the disk, a quota, or a limit on the size of files.
  bool full() const;

 private:
  Database(std::string file, sqlite3* database) : file_(std::move(file)), database_(database) {}

  const std::string file_;
  sqlite3* const database_;
};

}  // namespace coopdyn

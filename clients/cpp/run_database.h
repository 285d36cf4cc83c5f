// SPDX-License-Identifier: MIT
// The SQLite side of run_file.h: opens a recording and runs queries on it. Throws Error. One thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

struct sqlite3;
struct sqlite3_stmt;

namespace coopdyn::client {

/// The row that a query is at.
class RunRow {
 public:
  RunRow(sqlite3_stmt* statement, const std::string& file) : statement_(statement), file_(file) {}
  /// Throws Error 7 if it is no whole number.
  std::int64_t integer(int column) const;
  /// A whole number from 0 to 2^31. Throws Error 7 if it is none.
  std::int64_t count(int column) const;
  /// Throws Error 7 if it is no finite number.
  double number(int column) const;
  std::string text(int column) const;
  bool is_null(int column) const;
  /// Until the next row. Throws Error 7 if it is neither bytes nor NULL.
  std::span<const unsigned char> bytes(int column) const;

 private:
  sqlite3_stmt* statement_;
  const std::string& file_;
};

class RunDatabase {
 public:
  /// Checks what the file is.
  explicit RunDatabase(const std::string& file);
  ~RunDatabase();
  RunDatabase(const RunDatabase&) = delete;
  RunDatabase& operator=(const RunDatabase&) = delete;

  const std::string& file() const { return file_; }
  /// Calls `use` with each row. `text`, if not null, is what ?1 stands for.
  void ForEach(const std::string& sql, const std::function<void(const RunRow&)>& use,
               const std::string* text = nullptr) const;
  /// The error of a file that does not add up.
  [[noreturn]] static void Damaged(const std::string& file, const std::string& why);

 private:
  void Open(bool immutable);
  void Close();
  std::int64_t Pragma(const char* name) const;

  const std::string file_;
  sqlite3* database_ = nullptr;
};

}  // namespace coopdyn::client

// SPDX-License-Identifier: MIT
#include "server/record/sqlite_db.h"

#include <sqlite3.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace coopdyn {

namespace {

constexpr int kBusyTimeoutMs = 2000;

/// The error of the last call, including the system's reason. SQLite keeps errno only for opening, so each
/// call below clears errno first.
DatabaseError LastError(const std::string& file, sqlite3* database) {
  const int last = errno;
  if (database == nullptr) return DatabaseError(file + ": out of memory", SQLITE_NOMEM);
  const int code = sqlite3_errcode(database) & 0xff;
  if (code == SQLITE_FULL) return DatabaseError(file + ": the disk is full", code);
  std::string text = file + ": " + sqlite3_errmsg(database);
  if (code != SQLITE_IOERR && code != SQLITE_CANTOPEN) return DatabaseError(text, code);
  const int opening = sqlite3_system_errno(database);
  const int reason = opening != 0 ? opening : last;
  if (reason != 0) text += " (" + std::generic_category().message(reason) + ")";
  return DatabaseError(text, code, last);
}

}  // namespace

bool DatabaseError::busy() const {
  return code_ == SQLITE_BUSY || code_ == SQLITE_LOCKED;
}

bool DatabaseError::damaged() const {
  return code_ == SQLITE_NOTADB || code_ == SQLITE_CORRUPT || code_ == SQLITE_IOERR;
}

bool DatabaseError::full() const {
  const bool limited = reason_ == ENOSPC || reason_ == EDQUOT || reason_ == EFBIG;
  return code_ == SQLITE_FULL || (code_ == SQLITE_IOERR && limited);
}

void Statement::Finalize::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

void Statement::BindInteger(int parameter, std::int64_t value) {
  sqlite3_bind_int64(statement_.get(), parameter, value);
}

void Statement::Bind(int parameter, double value) {
  sqlite3_bind_double(statement_.get(), parameter, value);
}

void Statement::BindNull(int parameter) {
  sqlite3_bind_null(statement_.get(), parameter);
}

void Statement::Bind(int parameter, std::string_view text) {
  // A null pointer would bind NULL.
  sqlite3_bind_text64(statement_.get(), parameter, text.empty() ? "" : text.data(), text.size(),
                      SQLITE_STATIC, SQLITE_UTF8);
}

void Statement::Bind(int parameter, std::span<const std::byte> bytes) {
  if (bytes.empty()) return BindNull(parameter);
  sqlite3_bind_blob64(statement_.get(), parameter, bytes.data(), bytes.size(), SQLITE_STATIC);
}

bool Statement::Step() {
  errno = 0;
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) {
    sqlite3_reset(statement_.get());
    return false;
  }
  DatabaseError error = database_->last_error();
  sqlite3_reset(statement_.get());
  throw error;
}

void Statement::Reset() {
  sqlite3_reset(statement_.get());
}

int Statement::columns() const {
  return sqlite3_column_count(statement_.get());
}

Statement::Kind Statement::kind(int column) const {
  switch (sqlite3_column_type(statement_.get(), column)) {
    case SQLITE_INTEGER:
      return Kind::kInteger;
    case SQLITE_FLOAT:
      return Kind::kReal;
    case SQLITE_TEXT:
      return Kind::kText;
    case SQLITE_BLOB:
      return Kind::kBlob;
    default:
      return Kind::kNull;
  }
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

double Statement::real(int column) const {
  return sqlite3_column_double(statement_.get(), column);
}

std::string Statement::text(int column) const {
  const unsigned char* text = sqlite3_column_text(statement_.get(), column);
  if (text == nullptr) return {};
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  return {reinterpret_cast<const char*>(text), size};
}

std::span<const std::byte> Statement::blob(int column) const {
  const void* bytes = sqlite3_column_blob(statement_.get(), column);
  if (bytes == nullptr) return {};
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  return {static_cast<const std::byte*>(bytes), size};
}

void Database::Close::operator()(sqlite3* database) const {
  sqlite3_close_v2(database);
}

std::unique_ptr<Database> Database::Open(const std::string& file, Access access, std::string& error) {
  int flags = SQLITE_OPEN_NOMUTEX;
  flags |= access == Access::kReadOnly ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE;
  if (access == Access::kCreate) flags |= SQLITE_OPEN_CREATE;
  // With "./", even ":memory:" names a file.
  const std::string path = file.starts_with('/') ? file : "./" + file;
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &handle, flags, nullptr);
  std::unique_ptr<Database> database(new Database(file, handle));
  if (code != SQLITE_OK) {
    error = database->error();
    return nullptr;
  }
  sqlite3_busy_timeout(handle, kBusyTimeoutMs);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  database->Try("PRAGMA cell_size_check = ON");
  return database;
}

Statement Database::Prepare(std::string_view sql) const {
  errno = 0;
  sqlite3_stmt* prepared = nullptr;
  const int code =
      sqlite3_prepare_v2(database_.get(), sql.data(), static_cast<int>(sql.size()), &prepared, nullptr);
  if (code != SQLITE_OK) throw last_error();
  Statement statement;
  statement.statement_.reset(prepared);
  statement.database_ = this;
  return statement;
}

bool Database::Try(const std::string& sql) {
  errno = 0;
  return sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
}

void Database::Run(const std::string& sql) {
  if (!Try(sql)) throw last_error();
}

void Database::RollBack() {
  if (sqlite3_get_autocommit(database_.get()) == 0) Try("ROLLBACK");
}

void Database::MakePlain() {
  if (Text("PRAGMA journal_mode = DELETE") == "delete") return;
  throw DatabaseError(file_ + ": its log cannot be made part of it", SQLITE_BUSY);
}

DatabaseError Database::last_error() const {
  return LastError(file_, database_.get());
}

}  // namespace coopdyn

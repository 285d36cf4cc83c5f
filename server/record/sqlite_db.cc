// SPDX-License-Identifier: MIT
#include "server/record/sqlite_db.h"

#include <sqlite3.h>

#include <cerrno>
#include <system_error>

namespace coopdyn {

namespace {

constexpr int kBusyTimeoutMs = 2000;

/// `message (reason of the system)`.
std::string ErrorText(sqlite3* database) {
  const int last = errno;
  const int code = sqlite3_errcode(database) & 0xff;
  if (code == SQLITE_FULL) return "the disk is full";
  std::string text = sqlite3_errmsg(database);
  if (code != SQLITE_IOERR && code != SQLITE_CANTOPEN) return text;
  // SQLite keeps the reason of opening only; every call below clears errno, so it is that of the last one.
  const int opening = sqlite3_system_errno(database);
  const int reason = opening != 0 ? opening : last;
  if (reason != 0) text += " (" + std::generic_category().message(reason) + ")";
  return text;
}

}  // namespace

Statement::Statement(Statement&& other) noexcept
    : statement_(std::exchange(other.statement_, nullptr)), database_(other.database_) {}

Statement& Statement::operator=(Statement&& other) noexcept {
  std::swap(statement_, other.statement_);
  std::swap(database_, other.database_);
  return *this;
}

Statement::~Statement() {
  sqlite3_finalize(statement_);
}

void Statement::Bind(int parameter, std::int64_t value) {
  sqlite3_bind_int64(statement_, parameter, value);
}

void Statement::Bind(int parameter, double value) {
  sqlite3_bind_double(statement_, parameter, value);
}

void Statement::BindNull(int parameter) {
  sqlite3_bind_null(statement_, parameter);
}

void Statement::BindText(int parameter, std::string_view text) {
  // A null pointer would be NULL.
  sqlite3_bind_text64(statement_, parameter, text.empty() ? "" : text.data(), text.size(), SQLITE_STATIC,
                      SQLITE_UTF8);
}

void Statement::BindBlob(int parameter, std::span<const std::byte> bytes) {
  if (bytes.empty()) return BindNull(parameter);
  sqlite3_bind_blob64(statement_, parameter, bytes.data(), bytes.size(), SQLITE_STATIC);
}

bool Statement::Step() {
  errno = 0;
  switch (sqlite3_step(statement_)) {
    case SQLITE_ROW:
      return true;
    case SQLITE_DONE:
      sqlite3_reset(statement_);
      return false;
    default:
      if (database_ == nullptr) throw DatabaseError("a statement of no database", false);
      DatabaseError error(database_->error(), database_->busy());
      sqlite3_reset(statement_);
      throw error;
  }
}

bool Statement::Run() {
  errno = 0;
  int code = sqlite3_step(statement_);
  while (code == SQLITE_ROW) code = sqlite3_step(statement_);
  const int last = errno;  // that of the failure, for Database::error()
  const bool reset = sqlite3_reset(statement_) == SQLITE_OK;
  errno = last;
  return code == SQLITE_DONE && reset;
}

void Statement::Reset() {
  sqlite3_reset(statement_);
}

Statement::Kind Statement::kind(int column) const {
  switch (sqlite3_column_type(statement_, column)) {
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

bool Statement::is_null(int column) const {
  return sqlite3_column_type(statement_, column) == SQLITE_NULL;
}

bool Statement::is_integer(int column) const {
  return sqlite3_column_type(statement_, column) == SQLITE_INTEGER;
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_, column);
}

double Statement::real(int column) const {
  return sqlite3_column_double(statement_, column);
}

std::string Statement::text(int column) const {
  const unsigned char* text = sqlite3_column_text(statement_, column);
  if (text == nullptr) return {};
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
  return {reinterpret_cast<const char*>(text), size};
}

std::span<const std::byte> Statement::blob(int column) const {
  const void* bytes = sqlite3_column_blob(statement_, column);
  if (bytes == nullptr) return {};
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
  return {static_cast<const std::byte*>(bytes), size};
}

std::unique_ptr<Database> Database::Open(const std::string& file, Access access, std::string& error) {
  int flags = SQLITE_OPEN_NOMUTEX;
  switch (access) {
    case Access::kReadOnly:
      flags |= SQLITE_OPEN_READONLY;
      break;
    case Access::kReadWrite:
      flags |= SQLITE_OPEN_READWRITE;
      break;
    case Access::kCreate:
      flags |= SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
      break;
  }
  // So that ":memory:" is the name of a file like any other.
  const std::string path = file.starts_with('/') ? file : "./" + file;
  sqlite3* handle = nullptr;
  if (sqlite3_open_v2(path.c_str(), &handle, flags, nullptr) != SQLITE_OK) {
    error = file + ": " + (handle == nullptr ? "out of memory" : ErrorText(handle));
    sqlite3_close(handle);
    return nullptr;
  }
  std::unique_ptr<Database> database(new Database(file, handle));
  sqlite3_busy_timeout(handle, kBusyTimeoutMs);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_exec(handle, "PRAGMA cell_size_check = ON", nullptr, nullptr, nullptr);
  return database;
}

Database::~Database() {
  sqlite3_close_v2(database_);
}

Statement Database::Prepare(std::string_view sql) {
  errno = 0;
  sqlite3_stmt* statement = nullptr;
  sqlite3_prepare_v3(database_, sql.data(), static_cast<int>(sql.size()), SQLITE_PREPARE_PERSISTENT,
                     &statement, nullptr);
  return {statement, *this};
}

bool Database::Run(const std::string& sql) {
  errno = 0;
  return sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
}

std::optional<std::int64_t> Database::Integer(std::string_view sql) {
  Statement statement = Prepare(sql);
  if (!statement.Step() || statement.is_null(0)) return {};
  return statement.integer(0);
}

std::optional<std::string> Database::Text(std::string_view sql) {
  Statement statement = Prepare(sql);
  if (!statement.Step() || statement.is_null(0)) return {};
  return statement.text(0);
}

bool Database::MakePlain() try {
  return Text("PRAGMA journal_mode = DELETE") == "delete";
} catch (const DatabaseError&) {
  return false;
}

bool Database::in_transaction() const {
  return sqlite3_get_autocommit(database_) == 0;
}

std::string Database::error() const {
  const std::string text = ErrorText(database_);
  return file_ + ": " + text;
}

int Database::error_code() const {
  return sqlite3_errcode(database_) & 0xff;
}

bool Database::busy() const {
  const int code = error_code();
  return code == SQLITE_BUSY || code == SQLITE_LOCKED;
}

bool Database::full() const {
  const int last = errno;
  const int code = error_code();
  return code == SQLITE_FULL || (code == SQLITE_IOERR && (last == ENOSPC || last == EDQUOT || last == EFBIG));
}

bool Database::damaged() const {
  const int code = error_code();
  return code == SQLITE_NOTADB || code == SQLITE_CORRUPT || code == SQLITE_IOERR;
}

}  // namespace coopdyn

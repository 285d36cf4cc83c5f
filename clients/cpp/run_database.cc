// SPDX-License-Identifier: MIT
#include "clients/cpp/run_database.h"

#include <sqlite3.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "clients/cpp/error.h"

namespace coopdyn::client {
namespace {

constexpr std::int64_t kRunId = 0x434F4F50;  // SQLite's application_id of a recording
constexpr std::int64_t kRunFormat = 1;
constexpr int kBusy_ms = 2000;

/// A path as part of a URI.
std::string Escaped(const std::string& path) {
  std::string out;
  for (const char c : path) {
    if (c != '%' && c != '?' && c != '#' && static_cast<unsigned char>(c) > ' ') {
      out += c;
      continue;
    }
    char hex[4];
    std::snprintf(hex, sizeof(hex), "%%%02X", static_cast<unsigned char>(c));
    out += hex;
  }
  return out;
}

/// It holds what a recording has not put into its file yet.
bool HasLog(const std::string& file) {
  std::error_code failed;
  const auto size = std::filesystem::file_size(file + "-wal", failed);
  return !failed && size > 0;
}

}  // namespace

std::int64_t RunRow::integer(int column) const {
  if (sqlite3_column_type(statement_, column) != SQLITE_INTEGER)
    RunDatabase::Damaged(file_, "a number is missing");
  return sqlite3_column_int64(statement_, column);
}

std::int64_t RunRow::count(int column) const {
  const std::int64_t value = integer(column);
  if (value < 0 || value > (std::int64_t{1} << 31)) RunDatabase::Damaged(file_, "a place that cannot be");
  return value;
}

double RunRow::number(int column) const {
  const int type = sqlite3_column_type(statement_, column);
  const double value = sqlite3_column_double(statement_, column);
  if ((type != SQLITE_INTEGER && type != SQLITE_FLOAT) || !std::isfinite(value))
    RunDatabase::Damaged(file_, "a number is missing");
  return value;
}

std::string RunRow::text(int column) const {
  const auto* bytes = sqlite3_column_text(statement_, column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
  return bytes == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(bytes), size);
}

bool RunRow::is_null(int column) const {
  return sqlite3_column_type(statement_, column) == SQLITE_NULL;
}

std::span<const unsigned char> RunRow::bytes(int column) const {
  const int type = sqlite3_column_type(statement_, column);
  if (type != SQLITE_BLOB && type != SQLITE_NULL) RunDatabase::Damaged(file_, "bytes are missing");
  const auto* bytes = static_cast<const unsigned char*>(sqlite3_column_blob(statement_, column));
  return {bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

RunDatabase::RunDatabase(const std::string& file) : file_(file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    throw Error(10, "there is no file '" + file + "'; a recording is called NAME.run");
  if (file.ends_with(".mat"))
    throw Error(7, file + " is the run as MATLAB reads it (a .mat); here read the recording itself, " +
                       file.substr(0, file.size() - 4) +
                       ".run: sim.fetch_run(\"NAME\") copies it from the daemon");
  try {
    Open(false);
  } catch (...) {
    Close();
    throw;
  }
}

RunDatabase::~RunDatabase() {
  Close();
}

void RunDatabase::Open(bool immutable) {
  const std::string foreign = file_ + " is no recording of coopdyn (NAME.run)";
  const std::string uri = "file:" + Escaped(std::filesystem::absolute(file_).string()) + "?mode=ro" +
                          (immutable ? "&immutable=1" : "");
  int status = sqlite3_open_v2(uri.c_str(), &database_,
                               SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
  if (status == SQLITE_OK) {
    sqlite3_busy_timeout(database_, kBusy_ms);
    status = sqlite3_exec(database_, "PRAGMA trusted_schema = 0; SELECT count(*) FROM sqlite_master", nullptr,
                          nullptr, nullptr);
  }
  if (status == SQLITE_CANTOPEN && !immutable && !HasLog(file_)) {  // where nothing can be written
    Close();
    return Open(true);
  }
  const std::string why = sqlite3_errmsg(database_);
  const std::string cure =
      "run `coopdyn info " + file_ + "`, which mends what a crash has left, where the file can be written";
  if (status == SQLITE_NOTADB || status == SQLITE_CORRUPT)
    throw Error(7, foreign + ", or it is damaged (" + why + "); " + cure);
  if (status != SQLITE_OK) throw Error(5, "cannot read " + file_ + " (" + why + "): " + cure);
  if (Pragma("application_id") != kRunId) throw Error(7, foreign);
  if (const std::int64_t format = Pragma("user_version"); format != kRunFormat) {
    throw Error(5, file_ + " has format " + std::to_string(format) + ", this client reads format " +
                       std::to_string(kRunFormat) + ": build it from the daemon's sources");
  }
}

void RunDatabase::Close() {
  sqlite3_close_v2(database_);
  database_ = nullptr;
}

std::int64_t RunDatabase::Pragma(const char* name) const {
  std::int64_t value = 0;
  ForEach(std::string("PRAGMA ") + name, [&](const RunRow& row) { value = row.integer(0); });
  return value;
}

void RunDatabase::ForEach(const std::string& sql, const std::function<void(const RunRow&)>& use,
                          const std::string* text) const {
  sqlite3_stmt* prepared = nullptr;
  if (sqlite3_prepare_v2(database_, sql.c_str(), -1, &prepared, nullptr) != SQLITE_OK)
    Damaged(file_, sqlite3_errmsg(database_));
  const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement(prepared, &sqlite3_finalize);
  if (text != nullptr)
    sqlite3_bind_text(prepared, 1, text->data(), static_cast<int>(text->size()), SQLITE_TRANSIENT);
  const RunRow row(prepared, file_);
  int status = SQLITE_OK;
  while ((status = sqlite3_step(prepared)) == SQLITE_ROW) use(row);
  if (status != SQLITE_DONE) Damaged(file_, sqlite3_errmsg(database_));
}

void RunDatabase::Damaged(const std::string& file, const std::string& why) {
  throw Error(7, file + " is damaged (" + why + "); `coopdyn info " + file + "` says what can be read");
}

}  // namespace coopdyn::client

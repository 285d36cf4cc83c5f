// SPDX-License-Identifier: MIT
#include "clients/cpp/run_database.h"

#include <cmath>
#include <filesystem>

#include "clients/cpp/error.h"
#include "clients/cpp/words.h"

namespace coopdyn::client {
namespace {

constexpr std::int64_t kRunId = 0x434F4F50;  // SQLite's application_id of a recording
constexpr std::int64_t kRunFormat = 2;
constexpr int kBusy_ms = 2000;

/// True if a write-ahead log holds data that are not in the recording's file yet.
bool HasLog(const std::string& file) {
  std::error_code failed;
  const auto size = std::filesystem::file_size(file + "-wal", failed);
  return !failed && size > 0;
}

}  // namespace

std::int64_t RunRow::integer(int column) const {
  if (sqlite3_column_type(statement_, column) != SQLITE_INTEGER) database_.Damaged("a number is missing");
  return sqlite3_column_int64(statement_, column);
}

std::int64_t RunRow::count(int column) const {
  const std::int64_t value = integer(column);
  if (value < 0 || value > (std::int64_t{1} << 31)) database_.Damaged("a number is too large or below 0");
  return value;
}

double RunRow::number(int column) const {
  const int type = sqlite3_column_type(statement_, column);
  const double value = sqlite3_column_double(statement_, column);
  if ((type != SQLITE_INTEGER && type != SQLITE_FLOAT) || !std::isfinite(value))
    database_.Damaged("a number is missing");
  return value;
}

std::string RunRow::text(int column) const {
  const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
  return bytes == nullptr ? std::string() : std::string(bytes, size);
}

std::span<const unsigned char> RunRow::bytes(int column) const {
  if (!is_null(column) && sqlite3_column_type(statement_, column) != SQLITE_BLOB)
    database_.Damaged("bytes are missing");
  const auto* bytes = static_cast<const unsigned char*>(sqlite3_column_blob(statement_, column));
  return {bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

RunDatabase::RunDatabase(const std::string& file) : file_(file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    throw Error(10, "there is no file '" + file + "'; a recording is called NAME.run");
  if (file.ends_with(".mat"))
    throw Error(7, file + " is a MAT file for MATLAB; read the recording itself, " +
                       file.substr(0, file.size() - 4) + ".run: sim.fetch_run(\"NAME\") downloads it");
  int status = Open(false);
  if (status == SQLITE_CANTOPEN && !HasLog(file)) status = Open(true);  // read-only folder
  const std::string foreign = file + " is no recording of coopdyn (NAME.run)";
  const std::string why = sqlite3_errmsg(database_.get());
  const std::string cure =
      "run `coopdyn info " + file + "`, which repairs the file after a crash if it can be written";
  if (status == SQLITE_NOTADB || status == SQLITE_CORRUPT)
    throw Error(7, foreign + ", or it is damaged (" + why + "); " + cure);
  if (status != SQLITE_OK) throw Error(5, "cannot read " + file + " (" + why + "): " + cure);
  if (Pragma("application_id") != kRunId) throw Error(7, foreign);
  const std::int64_t format = Pragma("user_version");
  if (format < 1) {
    throw Error(7, file + " is damaged: its format is " + std::to_string(format) + ", not " +
                       std::to_string(kRunFormat) + "; " + cure);
  }
  if (format != kRunFormat) {
    const bool is_older = format < kRunFormat;
    throw Error(5, file + " was recorded in format " + std::to_string(format) + " by " +
                       (is_older ? "an older" : "a newer") + " coopdyn, this one reads " +
                       std::to_string(kRunFormat) + ": " +
                       (is_older ? "record it again" : "get that version of coopdyn and its clients"));
  }
}

/// Returns SQLite's status of opening and reading the file.
int RunDatabase::Open(bool immutable) {
  const std::string uri = "file:" + PercentEncoded(std::filesystem::absolute(file_).string(), "/") +
                          "?mode=ro" + (immutable ? "&immutable=1" : "");
  sqlite3* opened = nullptr;
  const int status = sqlite3_open_v2(uri.c_str(), &opened,
                                     SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
  database_.reset(opened);
  if (status != SQLITE_OK) return status;
  sqlite3_busy_timeout(opened, kBusy_ms);
  return sqlite3_exec(opened, "PRAGMA trusted_schema = 0; SELECT count(*) FROM sqlite_master", nullptr,
                      nullptr, nullptr);
}

std::int64_t RunDatabase::Pragma(const char* name) const {
  std::int64_t value = 0;
  ForEach(std::string("PRAGMA ") + name, [&](const RunRow& row) { value = row.integer(0); });
  return value;
}

void RunDatabase::ForEach(const std::string& sql, const std::function<void(const RunRow&)>& use,
                          const std::string* text) const {
  sqlite3_stmt* prepared = nullptr;
  int status = sqlite3_prepare_v2(database_.get(), sql.c_str(), -1, &prepared, nullptr);
  const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement(prepared, sqlite3_finalize);
  if (status == SQLITE_OK && text != nullptr)
    status = sqlite3_bind_text(prepared, 1, text->data(), static_cast<int>(text->size()), SQLITE_TRANSIENT);
  if (status == SQLITE_OK) {
    const RunRow row(prepared, *this);
    while ((status = sqlite3_step(prepared)) == SQLITE_ROW) use(row);
  }
  if (status != SQLITE_DONE) Damaged(sqlite3_errmsg(database_.get()));
}

void RunDatabase::Damaged(const std::string& why) const {
  throw Error(7, file_ + " is damaged (" + why + "); `coopdyn info " + file_ + "` says what can be read");
}

}  // namespace coopdyn::client

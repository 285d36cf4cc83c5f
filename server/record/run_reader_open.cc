// SPDX-License-Identifier: MIT
#include "server/record/run_reader_open.h"

#include <sqlite3.h>
#include <unistd.h>

#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "server/record/run_reader_journal.h"
#include "server/record/run_seal.h"
#include "server/record/run_tables.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

constexpr const char* kNoStepsText =
    ": nothing was recorded in it (its recorder ended before the first commit): delete it, or try again if "
    "it has only just begun";
constexpr const char* kOfAnotherProgram =
    " is not a recording of coopdyn: it is a database of another program; ";
constexpr const char* kHowToRecord = "recordings are made with coopdyn serve --record FILE";

bool IsPlainFile(const std::string& file, std::string& error) {
  std::error_code code;
  const fs::file_status status = fs::status(file, code);
  if (status.type() == fs::file_type::not_found) {
    error = file + ": there is no such file";
  } else if (status.type() == fs::file_type::directory) {
    error = file + " is a folder: write the name of a recording in it, for example " + file + "/lesson1.run";
  } else if (status.type() != fs::file_type::regular) {
    error = file + " is not a recording of coopdyn: it is no file" +
            (code ? " that can be read (" + code.message() + ")" : "");
  } else if (fs::file_size(file, code) == 0 && !code) {
    error = file + " is empty" + kNoStepsText;
  }
  return error.empty();
}

std::unique_ptr<Database> OpenDatabase(const std::string& file, Database::Access access, std::string& error) {
  auto database = Database::Open(file, access, error);
  if (database != nullptr) database->Run("PRAGMA busy_timeout = 500");
  return database;
}

/// SQLite needs an index beside a log to read it.
bool IsDiskFull(const std::string& log) {
  constexpr std::uintmax_t kIndexBytes = 32768;
  std::error_code code;
  const fs::space_info space = fs::space(fs::absolute(log).parent_path(), code);
  return !code && space.available < kIndexBytes;
}

bool MayWrite(const std::string& file, const std::string& log) {
  return ::access(file.c_str(), W_OK) == 0 && ::access(fs::absolute(log).parent_path().c_str(), W_OK) == 0;
}

/// Why `log` is no part of the file after Database::MakePlain() of `database`; null: it could not be opened.
std::string WhyApart(const Database* database, const std::string& file, const std::string& log) {
  if (database != nullptr && database->busy()) return "another program reads it";
  if (!MayWrite(file, log)) return "the file or its folder cannot be written to";
  if (IsDiskFull(log) || (database != nullptr && database->error_code() == SQLITE_FULL)) {
    return "the disk is full";
  }
  return database == nullptr ? "it cannot be opened for writing" : database->error();
}

/// Why the first look into `database` failed.
std::string WhyUnreadable(const Database& database) {
  const std::string& file = database.file();
  const std::string text = database.error();  // first: it looks at errno, as all else does that follows
  if (database.busy()) return file + " is locked by another program: try again when that has finished";
  if (database.error_code() == SQLITE_NOTADB) {
    return file + " is not a recording of coopdyn: it is no SQLite database; " + kHowToRecord;
  }
  const std::string log = UnmergedLog(file);
  if (!log.empty() && IsDiskFull(log) && BeginsAsRecording(file)) {
    return text + ": the recording was not closed, and the disk is full: make room there, or copy " + file +
           " and " + log + " together to another disk and open it there";
  }
  if (database.damaged()) {
    return file + " is damaged or cut short (" + text + "): copy it again from where it was recorded";
  }
  if (!log.empty()) {
    if (log.ends_with("-journal") && !BeginsAsRecording(file)) return file + kOfAnotherProgram + kHowToRecord;
    return text + ": the recording was not closed, and its folder cannot be written to: copy " + file +
           " and " + log + " together to a folder of yours and open it there";
  }
  return text + ": make sure that you may read it, or copy it to a folder of yours";
}

/// Its tables come with the first commit, together with the first step.
bool HasNoTables(Database& database) {
  return database.Integer("SELECT count(*) FROM sqlite_schema") == 0;
}

/// A reader is refused as long as a journal of a program that is gone waits.
bool NeedsRollBack(Database& database) {
  try {
    database.Integer("PRAGMA schema_version");
    return false;
  } catch (const DatabaseError&) {
    return database.error_code() == SQLITE_READONLY;
  }
}

/// It is a recording, of a format that is known.
bool CheckKind(Database& database, std::string& error) try {
  const std::string& file = database.file();
  const std::int64_t application = database.Integer("PRAGMA application_id").value_or(0);
  const std::int64_t format = database.Integer("PRAGMA user_version").value_or(0);
  if (application != kRunApplicationId) {
    error = file + kOfAnotherProgram + kHowToRecord;
  } else if (format > kRunFormat) {
    error = file + " was made by a newer coopdyn: format " + std::to_string(format) + ", this one reads " +
            std::to_string(kRunFormat) + ": use that version of coopdyn";
  } else if (format < 1 && HasNoTables(database)) {
    error = file + kNoStepsText;
  } else if (format < 1) {
    error = file + " is damaged: its format is " + std::to_string(format) + ", not " +
            std::to_string(kRunFormat) + ": copy it again from where it was recorded";
  }
  return error.empty();
} catch (const DatabaseError&) {
  error = WhyUnreadable(database);
  return false;
}

/// A plain file is whole pages.
bool IsCutShort(Database& database) {
  std::error_code code;
  const std::uintmax_t bytes = fs::file_size(database.file(), code);
  const std::optional<std::int64_t> page = database.Integer("PRAGMA page_size");
  return !code && page.value_or(0) > 0 && bytes % static_cast<std::uintmax_t>(*page) != 0;
}

/// False: its recorder has done it meanwhile, or it cannot be done.
bool MarkClosed(Database& database) try {
  const std::int64_t lost = static_cast<std::int64_t>(CountLost(database)) +
                            database.Integer("SELECT value FROM meta WHERE key = 'lost_after'").value_or(0);
  if (!database.Run("BEGIN IMMEDIATE")) return false;
  if (IsClosed(database)) {
    database.Run("ROLLBACK");
    return false;
  }
  // What was changed before does not become right by being mended.
  const bool sealed = IsSealed(database);
  if (SetMeta(database, "lost", lost) && SetMeta(database, "closed", 1) && (!sealed || Seal(database)) &&
      database.Run("COMMIT")) {
    return true;
  }
  database.Run("ROLLBACK");
  return false;
} catch (const DatabaseError&) {  // it is damaged, as those who read it there will find
  if (database.in_transaction()) database.Run("ROLLBACK");
  return false;
}

}  // namespace

std::string UnmergedLog(const std::string& file) {
  std::error_code code;
  // SQLite keeps them beside the file that a link stands for.
  const std::string real = fs::is_symlink(file, code) ? fs::canonical(file, code).string() : file;
  for (const char* ending : {"-journal", "-wal"}) {
    const std::string log = real + ending;
    const std::uintmax_t bytes = fs::file_size(log, code);
    if (!code && bytes > 0) return log;
  }
  return {};
}

std::string UnfinishedText(const std::string& error) {
  return error +
         ": it is damaged, or its recording has only just begun: try again, or copy it again from where it "
         "was recorded";
}

bool IsClosed(Database& database) {
  return database.Integer("SELECT value FROM meta WHERE key = 'closed'") == 1;
}

std::uint64_t CountLost(Database& database) {
  Statement gaps = database.Prepare(
      "SELECT k.step - 1 - (SELECT step FROM step WHERE step < k.step ORDER BY step DESC LIMIT 1)"
      " FROM keyframe AS k WHERE k.step > (SELECT min(step) FROM step)");
  std::uint64_t lost = 0;
  while (gaps.Step()) {
    if (gaps.integer(0) > 0) lost += static_cast<std::uint64_t>(gaps.integer(0));
  }
  return lost;
}

OpenedRun OpenRun(const std::string& file, std::string& error) try {
  OpenedRun run;
  error.clear();
  if (!IsPlainFile(file, error)) return run;
  // Read-only at first: a stranger's database must not be touched.
  run.database = OpenDatabase(file, Database::Access::kReadOnly, error);
  if (run.database == nullptr) return {};
  if (NeedsRollBack(*run.database) && RollBack(file)) {
    run.mended = true;
    run.database.reset();
    if (!IsPlainFile(file, error)) return {};
    run.database = OpenDatabase(file, Database::Access::kReadOnly, error);
  }
  if (run.database == nullptr || !CheckKind(*run.database, error)) return {};
  const bool closed = !HasNoTables(*run.database) && IsClosed(*run.database);
  const bool plain = run.database->Text("PRAGMA journal_mode") != "wal";
  if (plain && IsCutShort(*run.database)) {
    error = file + " is cut short: copy it again from where it was recorded";
    return {};
  }
  if (plain && closed) return run;

  // A writer keeps the file in WAL mode and has it open; then it cannot be made plain.
  run.database.reset();
  std::string ignored;
  auto writable = OpenDatabase(file, Database::Access::kReadWrite, ignored);
  if (writable != nullptr) {
    if (writable->MakePlain()) {
      run.mended |= !closed && MarkClosed(*writable);
    } else {
      run.growing = writable->busy() && !closed;
    }
  }
  if (run.growing) {
    run.log_reason = "it is being recorded, or another program reads it";
  } else if (const std::string log = UnmergedLog(file); !log.empty()) {
    run.log_reason = WhyApart(writable.get(), file, log);
  }
  writable.reset();
  run.database = OpenDatabase(file, Database::Access::kReadOnly, error);
  if (run.database != nullptr && !CheckKind(*run.database, error)) run.database.reset();
  if (run.database != nullptr && HasNoTables(*run.database)) {
    error = file + kNoStepsText;
    run.database.reset();
  }
  if (run.database != nullptr && run.growing) run.growing = !IsClosed(*run.database);
  return run;
} catch (const DatabaseError& failed) {
  error = UnfinishedText(failed.what());
  OpenedRun run;
  run.growing = failed.busy();
  return run;
}

}  // namespace coopdyn

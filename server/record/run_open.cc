// SPDX-License-Identifier: MIT
#include "server/record/run_open.h"

#include <sqlite3.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include "server/model/values.h"
#include "server/record/row_chain.h"
#include "server/record/run_tables.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

constexpr std::string_view kDatabaseMagic = "SQLite format 3\0"sv;
constexpr std::size_t kApplicationIdAt = 68;  // big-endian
constexpr std::string_view kJournalMagic = "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7"sv;

constexpr const char* kNoStepsText =
    ": nothing was recorded in it (its recorder ended before the first commit): delete it, or try again if "
    "it has only just begun";
constexpr const char* kOfAnotherProgram =
    " is not a recording of coopdyn: it is a database of another program; ";
constexpr const char* kHowToRecord = "recordings are made with coopdyn serve --record FILE";

/// Thrown if the file cannot be read as a recording: what() says why and what to do.
class CannotOpen final : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The first or last kSize bytes of `file`; all zero if the file is shorter.
template <std::size_t kSize>
std::array<char, kSize> Bytes(const std::string& file, std::ios::seekdir from) {
  std::array<char, kSize> bytes{};
  std::ifstream in(file, std::ios::binary);
  in.seekg(from == std::ios::beg ? 0 : -static_cast<std::streamoff>(kSize), from);
  if (!in.read(bytes.data(), kSize)) bytes.fill(0);
  return bytes;
}

/// A journal that ends with the magic names a file shared by several databases, which SQLite may delete. No
/// recorder makes such a journal.
bool IsOfRecorder(const std::string& journal) {
  const auto end = Bytes<kJournalMagic.size()>(journal, std::ios::end);
  return std::string_view(end.data(), end.size()) != kJournalMagic;
}

/// The end of an error message: the recording in the folder of `file` that the user may mean, or what to do.
std::string NearRecording(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  std::vector<std::string> names;
  std::error_code ignored;
  for (fs::directory_iterator it(folder, ignored), end; !ignored && it != end; it.increment(ignored)) {
    if (it->path().extension() == ".run") names.push_back(it->path().filename());
  }
  const std::string nearest = Nearest(file.filename().string(), names);
  if (nearest.empty()) return "; coopdyn info *.run lists the recordings of a folder";
  return "; did you mean " + (file.parent_path() / nearest).string() + "?";
}

void CheckIsFile(const std::string& file) {
  std::error_code code;
  const fs::file_status status = fs::status(file, code);
  if (status.type() == fs::file_type::not_found)
    throw CannotOpen(file + ": there is no such file" + NearRecording(file));
  if (status.type() == fs::file_type::directory) {
    throw CannotOpen(file + " is a folder: write the name of a recording in it, for example " + file +
                     "/lesson1.run");
  }
  if (status.type() != fs::file_type::regular) {
    throw CannotOpen(file + " is not a recording of coopdyn: it is no file" +
                     (code ? " that can be read (" + code.message() + ")" : ""));
  }
  if (fs::file_size(file, code) == 0 && !code) throw CannotOpen(file + " is empty" + kNoStepsText);
}

std::unique_ptr<Database> OpenDatabase(const std::string& file, Database::Access access, std::string& error) {
  auto database = Database::Open(file, access, error);
  if (database != nullptr) database->Try("PRAGMA busy_timeout = 500");
  return database;
}

std::unique_ptr<Database> OpenToRead(const std::string& file) {
  std::string error;
  auto database = OpenDatabase(file, Database::Access::kReadOnly, error);
  return database != nullptr ? std::move(database) : throw CannotOpen(error);
}

/// SQLite needs room for an index beside the log to read it.
bool IsDiskFull(const std::string& log) {
  constexpr std::uintmax_t kIndexBytes = 32768;
  std::error_code code;
  const fs::space_info space = fs::space(fs::absolute(log).parent_path(), code);
  return !code && space.available < kIndexBytes;
}

bool MayWrite(const std::string& file, const std::string& log) {
  return ::access(file.c_str(), W_OK) == 0 && ::access(fs::absolute(log).parent_path().c_str(), W_OK) == 0;
}

/// Why `log` was not merged into the file. `failed`: the error of Database::MakePlain(); nullopt if the file
/// could not be opened for writing.
std::string WhyApart(const std::optional<DatabaseError>& failed, const std::string& file,
                     const std::string& log) {
  if (failed && failed->busy()) return "another program reads it";
  if (!MayWrite(file, log)) return "the file or its folder cannot be written to";
  if (IsDiskFull(log) || (failed && failed->code() == SQLITE_FULL)) return "the disk is full";
  return failed ? failed->what() : "it cannot be opened for writing";
}

/// Why the first read of `file` failed.
std::string WhyUnreadable(const std::string& file, const DatabaseError& failed) {
  const std::string text = failed.what();
  if (failed.busy()) return file + " is locked by another program: try again when that has finished";
  if (failed.code() == SQLITE_NOTADB) {
    return file + " is not a recording of coopdyn: it is no SQLite database; " + kHowToRecord;
  }
  const std::string log = UnmergedLog(file);
  if (!log.empty() && IsDiskFull(log) && BeginsAsRecording(file)) {
    return text + ": the recording was not closed, and the disk is full: make room there, or copy " + file +
           " and " + log + " together to another disk and open it there";
  }
  if (failed.damaged()) {
    return file + " is damaged or cut short (" + text + "): copy it again from where it was recorded";
  }
  if (!log.empty()) {
    if (log.ends_with("-journal") && !BeginsAsRecording(file)) return file + kOfAnotherProgram + kHowToRecord;
    return text + ": the recording was not closed, and its folder cannot be written to: copy " + file +
           " and " + log + " together to a folder of yours and open it there";
  }
  return text + ": make sure that you may read it, or copy it to a folder of yours";
}

/// True before the first commit, which creates the tables and the first step.
bool HasNoTables(const Database& database) {
  return database.Integer("SELECT count(*) FROM sqlite_schema") == 0;
}

/// SQLite refuses readers while a rollback journal lies beside the file. A recorder leaves one if it is
/// killed while it makes the file or makes it plain at the end.
bool NeedsRollBack(const Database& database) try {
  database.Integer("PRAGMA schema_version");
  return false;
} catch (const DatabaseError& failed) {
  return failed.code() == SQLITE_READONLY;
}

/// Makes SQLite roll `file` back if a journal lies beside it and both were made by a recorder. True if the
/// journal is gone.
bool RollBack(const std::string& file) {
  const std::string journal = UnmergedLog(file);
  if (!journal.ends_with("-journal") || !IsOfRecorder(journal) || !BeginsAsRecording(file)) return false;
  std::string ignored;
  const auto database = Database::Open(file, Database::Access::kReadWrite, ignored);
  if (database == nullptr) return false;
  database->Try("PRAGMA schema_version");  // any read of the file rolls it back
  std::error_code code;
  return !fs::exists(journal, code) && !code;
}

/// Throws unless `database` is a recording of a known format.
void CheckKind(const Database& database) try {
  const std::string& file = database.file();
  const std::int64_t application = database.Integer("PRAGMA application_id").value_or(0);
  const std::int64_t format = database.Integer("PRAGMA user_version").value_or(0);
  if (application != kRunApplicationId) throw CannotOpen(file + kOfAnotherProgram + kHowToRecord);
  if (format < 1 && HasNoTables(database)) throw CannotOpen(file + kNoStepsText);
  if (format >= 1 && format != kRunFormat) {
    const bool is_older = format < kRunFormat;
    throw CannotOpen(file + " was recorded in format " + std::to_string(format) + " by " +
                     (is_older ? "an older" : "a newer") + " coopdyn, this one reads " +
                     std::to_string(kRunFormat) + ": " +
                     (is_older ? "record it again" : "get that version of coopdyn and its clients"));
  }
  if (format < 1) {
    throw CannotOpen(file + " is damaged: its format is " + std::to_string(format) + ", not " +
                     std::to_string(kRunFormat) + ": copy it again from where it was recorded");
  }
} catch (const DatabaseError& failed) {
  throw CannotOpen(WhyUnreadable(database.file(), failed));
}

/// A plain file consists of whole pages.
bool IsCutShort(const Database& database) {
  std::error_code code;
  const std::uintmax_t bytes = fs::file_size(database.file(), code);
  const std::int64_t page = database.Integer("PRAGMA page_size").value_or(0);
  return !code && page > 0 && bytes % static_cast<std::uintmax_t>(page) != 0;
}

/// Counts the steps left out from the gaps before keyframes: a keyframe follows all lost steps.
std::int64_t CountLost(const Database& database) {
  Statement gaps = database.Prepare(
      "SELECT k.step - 1 - (SELECT step FROM step WHERE step < k.step ORDER BY step DESC LIMIT 1)"
      " FROM keyframe AS k WHERE k.step > (SELECT min(step) FROM step)");
  std::int64_t lost = 0;
  while (gaps.Step()) lost += std::max<std::int64_t>(gaps.integer(0), 0);
  return lost;
}

/// Marks the recording as closed. False if its recorder has done so meanwhile or writing fails.
bool MarkClosed(Database& database) try {
  const std::int64_t lost =
      CountLost(database) + database.Integer("SELECT value FROM meta WHERE key = 'lost_after'").value_or(0);
  database.Run("BEGIN IMMEDIATE");
  const bool closed = IsClosed(database);
  if (!closed) {
    // Do not seal a file that was changed before.
    const bool sealed = IsSealed(database);
    SetMeta(database, "lost", lost);
    SetMeta(database, "closed", 1);
    if (sealed) Seal(database);
  }
  database.Run("COMMIT");
  return !closed;
} catch (const DatabaseError&) {  // damaged: readers will report it
  database.RollBack();
  return false;
}

/// Fills `run` step by step. Throws CannotOpen and DatabaseError.
void Open(const std::string& file, OpenedRun& run) {
  CheckIsFile(file);
  // Read-only at first: another program's database must not be modified.
  run.database = OpenToRead(file);
  if (NeedsRollBack(*run.database) && RollBack(file)) {
    run.mended = true;
    run.database.reset();
    CheckIsFile(file);
    run.database = OpenToRead(file);
  }
  CheckKind(*run.database);
  const bool closed = !HasNoTables(*run.database) && IsClosed(*run.database);
  const bool plain = run.database->Text("PRAGMA journal_mode") != "wal";
  if (plain && IsCutShort(*run.database)) {
    throw CannotOpen(file + " is cut short: copy it again from where it was recorded");
  }
  if (plain && closed) return;

  // A live writer has the file open in WAL mode: making it plain fails.
  run.database.reset();
  std::string ignored;
  auto writable = OpenDatabase(file, Database::Access::kReadWrite, ignored);
  std::optional<DatabaseError> failed;
  if (writable != nullptr) {
    try {
      writable->MakePlain();
      run.mended |= !closed && MarkClosed(*writable);
    } catch (const DatabaseError& refused) {
      failed = refused;
      run.growing = refused.busy() && !closed;
    }
  }
  if (run.growing) {
    run.log_reason = "it is being recorded, or another program reads it";
  } else if (const std::string log = UnmergedLog(file); !log.empty()) {
    run.log_reason = WhyApart(failed, file, log);
  }
  writable.reset();
  run.database = OpenToRead(file);
  CheckKind(*run.database);
  if (HasNoTables(*run.database)) throw CannotOpen(file + kNoStepsText);
  if (run.growing) run.growing = !IsClosed(*run.database);
}

}  // namespace

bool BeginsAsRecording(const std::string& file) {
  const auto head = Bytes<kApplicationIdAt + 4>(file, std::ios::beg);
  std::uint32_t id = 0;
  for (std::size_t i = kApplicationIdAt; i < head.size(); ++i) {
    id = id << 8 | static_cast<unsigned char>(head[i]);
  }
  return std::string_view(head.data(), head.size()).starts_with(kDatabaseMagic) && id == kRunApplicationId;
}

std::string UnmergedLog(const std::string& file) {
  std::error_code code;
  // SQLite keeps logs beside the target of a symbolic link.
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

bool IsClosed(const Database& database) {
  return database.Integer("SELECT value FROM meta WHERE key = 'closed'") == 1;
}

OpenedRun OpenRun(const std::string& file, std::string& error) {
  OpenedRun run;
  error.clear();
  try {
    Open(file, run);
    return run;
  } catch (const CannotOpen& refusal) {
    error = refusal.what();
  } catch (const DatabaseError& failed) {
    error = UnfinishedText(failed.what());
    run.growing = failed.busy();
  }
  run.database.reset();
  return run;
}

}  // namespace coopdyn

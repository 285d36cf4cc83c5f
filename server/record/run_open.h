// SPDX-License-Identifier: MIT
// Opens the file of a recording: rejects other files, distinguishes a recording in progress from one left by
// a crash, and mends the latter. Writes only to recordings, and only if no other program has the file open.
// One thread.
#pragma once

#include <memory>
#include <string>

#include "server/record/sqlite_db.h"

namespace coopdyn {

struct OpenedRun {
  std::unique_ptr<Database> database;  // read-only; null if it cannot be read
  bool mended = false;                 // the recording had not been closed and is now
  bool growing = false;                // not closed, and another connection has it open
  std::string log_reason;              // why a log beside the file could not be merged into it
};

/// Waits at most a second for other programs' locks. On failure `database` is null and `error` says what is
/// wrong and what to do; `growing` is true if the recorder has made the file but not yet written to it.
OpenedRun OpenRun(const std::string& file, std::string& error);

/// Whether `file` begins like a recording. Reads the bytes without SQLite.
bool BeginsAsRecording(const std::string& file);

/// The name of a non-empty `-wal` or `-journal` of SQLite beside `file`; empty if there is none. With such a
/// log the file alone is not the whole run: copy both.
std::string UnmergedLog(const std::string& file);

/// `error` with advice, for a missing table or column.
std::string UnfinishedText(const std::string& error);

/// Whether meta says that the recording was closed. Throws DatabaseError.
bool IsClosed(const Database& database);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Opens the file of a recording: says what is no recording, tells one that is being written from one that a
// crash has left, and mends the latter. Only the file of a recording is ever written to, and only if no other
// program has it open. One thread.
#pragma once

#include <memory>
#include <string>

#include "server/record/sqlite_db.h"

namespace coopdyn {

struct OpenedRun {
  std::unique_ptr<Database> database;  // to read from; null: it cannot be read
  bool mended = false;                 // it had not been closed; it is now
  bool growing = false;                // another connection has it open, and it is not closed
  std::string log_reason;              // why a log that lies beside it could not be made part of the file
};

/// Waits at most a second for locks of others. `database` is null with `error`, what is wrong and what to do;
/// `growing` may be true then, too: its recorder has made the file and not yet written to it.
OpenedRun OpenRun(const std::string& file, std::string& error);

/// Looks at the bytes, without SQLite: `file` begins as a recording does.
bool BeginsAsRecording(const std::string& file);

/// The name of the `-wal` or `-journal` with bytes in it that SQLite has beside `file`: the file alone is not
/// the whole run, copy both. Empty: there is none.
std::string UnmergedLog(const std::string& file);

/// What to do after `error`, when a table or column is missing.
std::string UnfinishedText(const std::string& error);

/// Whether meta says that the recording was closed. Throws DatabaseError.
bool IsClosed(const Database& database);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// `coopdyn info RUN...`: what recordings hold. Main thread.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "server/record/run_reader.h"

namespace coopdyn {

struct InfoOptions {
  std::vector<std::string> files;
  bool events = false;          // list them all, not the notes alone
  bool json = false;            // one array, an object per recording
  bool count_commands = false;  // also in a large file, which takes a while
};

/// Larger files are not looked through for their commands unless asked.
inline constexpr std::uint64_t kCountCommandsBytes = std::uint64_t{256} << 20;

/// What there is to say of one recording.
struct RunInfo {
  std::string file;
  RunHeader header;
  RunExtent extent;
  RunContents contents;
  std::optional<std::uint64_t> commands;  // empty: not counted
  std::vector<Event> events;
  bool mended = false, growing = false;
  std::string damage;      // what is not as it was written; empty: nothing, or it was not looked for
  std::string log;         // the file beside it without which it is not whole; empty: it is one file
  std::string log_reason;  // why that is not part of it
};
/// Nothing with `error` if the recording cannot be read.
std::optional<RunInfo> ReadRunInfo(const std::string& file, bool count_commands, std::string& error);
/// Some lines, each ended by '\n'.
std::string ToText(const RunInfo& info, bool all_events);
/// One line of JSON without '\n'; the same keys for every recording, null for what is not known.
std::string ToJson(const RunInfo& info);

/// Writes to `out`, and what cannot be read to `errors`. Returns the exit code.
int Info(const InfoOptions& options, std::ostream& out, std::ostream& errors);

}  // namespace coopdyn

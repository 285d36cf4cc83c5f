// SPDX-License-Identifier: MIT
// `coopdyn info RUN...`: prints the contents of recordings. Main thread.
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
  bool events = false;          // list all, not only notes
  bool json = false;            // one array with an object per recording
  bool count_commands = false;  // also in a large file, which is slow
};

/// Commands of larger files are counted only on request.
inline constexpr std::uint64_t kCountCommandsBytes = std::uint64_t{256} << 20;

/// The information about one recording.
struct RunInfo {
  std::string file;
  RunHeader header;
  RunExtent extent;
  RunContents contents;
  std::optional<std::uint64_t> commands;  // nullopt: not counted
  std::vector<Event> events;
  bool mended = false, growing = false;
  std::string damage;      // what was changed after writing; empty: nothing, or not checked
  std::string log;         // file beside it that belongs to the run; empty: none
  std::string log_reason;  // why the log was not merged into the file
};
/// Nullopt with `error` if the recording cannot be read.
std::optional<RunInfo> ReadRunInfo(const std::string& file, bool count_commands, std::string& error);
/// Several lines, each ending with '\n'.
std::string ToText(const RunInfo& info, bool all_events);
/// One line of JSON without '\n'; the same keys for every recording, null for unknown values.
std::string ToJson(const RunInfo& info);

/// Writes the information to `out` and reading errors to `errors`. Returns the exit code.
int Info(const InfoOptions& options, std::ostream& out, std::ostream& errors);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Runs another program to its end and collects its output. Any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace coopdyn {

struct ProgramEnd {
  int status = 0;          // wait status as from waitpid()
  std::string out, error;  // its stdout and stderr

  bool succeeded() const;
  /// The last non-blank line of `error`, or else of `out`, made printable.
  std::string LastWords() const;
};

enum class NoEnd { kNone, kNoProgram, kTooLong };

/// Runs `program`, a path or a name in PATH, with an empty stdin. Returns nullopt and sets `why` if the
/// program cannot be started, or if it is killed because it writes nothing for a minute or more than
/// `most_bytes`.
std::optional<ProgramEnd> RunProgram(const std::string& program, const std::vector<std::string>& arguments,
                                     std::size_t most_bytes, NoEnd& why);

}  // namespace coopdyn

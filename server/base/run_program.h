// SPDX-License-Identifier: MIT
// Runs another program to its end and takes what it writes. Any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace coopdyn {

struct ProgramEnd {
  int status = 0;          // as waitpid() gives it
  std::string out, error;  // its stdout and stderr

  bool succeeded() const;
  /// The last line of `error`, or else of `out`, that says something, fit for a terminal.
  std::string LastWords() const;
};

enum class NoEnd { kNone, kNoProgram, kTooLong };

/// What `program`, a path or a name in PATH, writes. Its stdin is empty. Nothing, and `why` says why, if it
/// cannot be started; or if it writes nothing for a minute, or more than `most_bytes`, and then it is killed.
std::optional<ProgramEnd> RunProgram(const std::string& program, const std::vector<std::string>& arguments,
                                     std::size_t most_bytes, NoEnd& why);

}  // namespace coopdyn

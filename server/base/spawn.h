// SPDX-License-Identifier: MIT
// Starts other programs and waits for them to end. Any thread.
#pragma once

#include <sys/types.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace coopdyn {

/// kGroup: the program has its own process group; Ctrl-C in the terminal reaches only coopdyn, which then
/// ends the program. kSession: it has its own session; it outlives coopdyn and the terminal, and the kernel
/// gives the session its own fair share of the processors (autogroup, sched(7)).
enum class SpawnApart { kGroup, kSession };

/// Starts `program`, a path or a name in PATH, with only `streams` open as its stdin, stdout and stderr, and
/// with default signal handling. Returns 0 or an errno code.
int Spawn(const std::string& program, const std::vector<std::string>& arguments,
          const std::array<int, 3>& streams, pid_t& process, SpawnApart apart = SpawnApart::kGroup);

/// The path of coopdyn's own program `name`: in this program's folder or, for tests, in the build folder
/// above it. Never searches PATH. Empty if the program is missing.
std::filesystem::path OwnProgram(const std::string& name);

/// Waits for `process` to end. Returns its wait status.
int WaitFor(pid_t process);

}  // namespace coopdyn

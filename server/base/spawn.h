// SPDX-License-Identifier: MIT
// Starts other programs and waits for their end. Any thread.
#pragma once

#include <sys/types.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace coopdyn {

/// kGroup: Ctrl-C in the terminal is for us, and we end the program. kSession: it also outlives us and the
/// terminal, and the kernel gives it a fair share of the processors of its own (sched(7), autogroup).
enum class SpawnApart { kGroup, kSession };

/// Starts `program`, a path or a name that is looked up in PATH, with these files as its stdin, stdout and
/// stderr and no others, and with signals as a program expects them. Returns 0, or an errno code.
int Spawn(const std::string& program, const std::vector<std::string>& arguments,
          const std::array<int, 3>& streams, pid_t& process, SpawnApart apart = SpawnApart::kGroup);

/// The program `name` of ours, in the folder of this program or, for tests, in the build's folder above:
/// nobody else's. Empty if it is not there.
std::filesystem::path OwnProgram(const std::string& name);

/// Waits for the end of `process`. Returns its wait status.
int WaitFor(pid_t process);

}  // namespace coopdyn

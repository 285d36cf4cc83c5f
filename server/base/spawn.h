// SPDX-License-Identifier: MIT
// Starts other programs and waits for their end. Any thread.
#pragma once

#include <sys/types.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace coopdyn {

/// Starts `program`, a path or a name that is looked up in PATH, with these files as its stdin, stdout and
/// stderr and no others, with signals as a program expects them, and in a process group of its own: Ctrl-C in
/// the terminal is for us, and we end it. Returns 0, or an errno code.
int Spawn(const std::string& program, const std::vector<std::string>& arguments,
          const std::array<int, 3>& streams, pid_t& process);

/// The program `name` of ours, in the folder of this program or, for tests, in the build's folder above:
/// nobody else's. Empty if it is not there.
std::filesystem::path OwnProgram(const std::string& name);

/// Waits for the end of `process`. Returns its wait status.
int WaitFor(pid_t process);

}  // namespace coopdyn

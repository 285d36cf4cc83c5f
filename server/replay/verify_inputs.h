// SPDX-License-Identifier: MIT
// What two recordings were given, against each other: commands whose hashes are equal, other inputs, lengths
// of steps. One thread, as the readers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/record/run_reader.h"
#include "server/replay/verify.h"

namespace coopdyn {

/// Goes along steps that are equal in both recordings; their commands need not be.
class CommandCompare {
 public:
  CommandCompare(RunReader& one, RunReader& other) : runs_{&one, &other} {}
  /// Both by increasing channel.
  void Look(std::uint64_t step, const std::vector<CommandRecord>& one,
            const std::vector<CommandRecord>& other);
  /// What was commanded in one run only, if nothing is damaged; lines, empty: nothing.
  std::string ToString() const;

 private:
  /// Which run was the first to be sent commands that were in force already, and when.
  struct Again {
    const RunReader* run;
    std::uint64_t step;
  };

  std::array<const RunReader*, 2> runs_;
  const RunReader* only_ = nullptr;  // that alone has the commands of controllers
  std::optional<Again> again_;
};

/// How long step `step` took, if it did not take as long in both.
std::optional<Difference> FindStepLength(RunReader& one, RunReader& other, std::uint64_t step);

/// The first input after steps first…last, of those that decide what a step gives, which is not in both
/// recordings; empty: none.
std::string InputsThatDiffer(RunReader& one, RunReader& other, std::uint64_t first, std::uint64_t last);

}  // namespace coopdyn

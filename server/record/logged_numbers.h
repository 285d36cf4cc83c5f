// SPDX-License-Identifier: MIT
// The numbers that were logged in a recorded run (events of level `log`), by name and step. A value; any
// thread.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "server/state/run_control.h"

namespace coopdyn {

class LoggedNumbers {
 public:
  /// `events` follow those that were added before; only those of level `log` count.
  void Add(std::span<const Event> events);
  /// The names that were logged by `step`.
  std::vector<std::string> Names(std::uint64_t step) const;
  /// What holds of `name` at `step`: the newest number by then; null: there is none yet.
  const Logged* Find(const std::string& name, std::uint64_t step) const;
  /// The same of all names.
  std::map<std::string, Logged> At(std::uint64_t step) const;

 private:
  std::map<std::string, std::vector<Logged>> by_name_;  // of each by step
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Numbers logged in a recorded run (events of level `log`), by name and step. A value type; any thread.
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
  /// `events` follow the events added before; only events of level `log` count.
  void Add(std::span<const Event> events);
  /// Names logged at or before `step`.
  std::vector<std::string> Names(std::uint64_t step) const;
  /// The newest number of `name` at or before `step`; null if there is none.
  const Logged* Find(const std::string& name, std::uint64_t step) const;
  /// The newest number of every name at or before `step`.
  std::map<std::string, Logged> At(std::uint64_t step) const;

 private:
  std::map<std::string, std::vector<Logged>> by_name_;  // each sorted by step
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Building blocks of the command tables. Pure.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "protocol/command_table.h"

namespace coopdyn {

inline ValueSpec Value(std::string name, std::string unit = "") {
  return {.name = std::move(name), .unit = std::move(unit)};
}

inline ValueSpec Optional(std::string name, std::string unit = "") {
  return {.name = std::move(name), .unit = std::move(unit), .optional = true};
}

inline ValueSpec Repeated(std::string name, std::string unit = "") {
  return {.name = std::move(name), .unit = std::move(unit), .repeated = true};
}

/// A command without arguments whose reply carries `data`.
inline CommandSpec Reading(std::int32_t id, std::string name, std::string help, std::vector<ValueSpec> data) {
  std::string example = name;
  return {.id = id,
          .name = std::move(name),
          .help = std::move(help),
          .reply_data = std::move(data),
          .example = std::move(example)};
}

/// A command without arguments whose reply carries only time and step.
inline CommandSpec Order(std::int32_t id, std::string name, std::string help) {
  return Reading(id, std::move(name), std::move(help), {});
}

}  // namespace coopdyn

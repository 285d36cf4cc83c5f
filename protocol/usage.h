// SPDX-License-Identifier: MIT
// How a command is written: its arguments, an example line, and count checks. Pure; any thread.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "protocol/command_table.h"

namespace coopdyn {

/// Number of values before the repeating group.
std::size_t FixedCount(std::span<const ValueSpec> values);
/// The spec of value `index` (from 0) with repeating groups unrolled; null beyond the last.
const ValueSpec* ValueAt(std::span<const ValueSpec> values, std::size_t index);
/// True if `values` allow `count` values.
bool CountFits(std::span<const ValueSpec> values, std::size_t count);
/// True if the command takes neither text nor values.
bool TakesNothing(const CommandSpec& spec);
/// The params that a named line gives without brackets: all, or only the required ones if data follow.
std::span<const ValueSpec> BareParams(const CommandSpec& spec);

/// A named line with the names of the values, e.g. `set_velocity [(steps)] linear angular`.
std::string Usage(const CommandSpec& spec);
/// A valid named line, e.g. `set_velocity 0.2 0.5`.
std::string ExampleLine(const CommandSpec& spec);
/// `linear (m/s) and angular (rad/s)`; `nothing` if empty.
std::string ListOf(std::span<const ValueSpec> values);
/// `realtime (0), lockstep (1) or free (2)`.
std::string ListOfEnums(const ValueSpec& value);
/// ` (…)` with the advice for values that are not enum words; empty if the spec has none.
std::string Instead(const ValueSpec& value);
/// One cell of the tables in docs/protocol.md, e.g. `[steps], left rad/s`; `–` if empty. A repeating value
/// ends with …, a repeating group also has brackets. `words`: include the numbers of enum words.
std::string ValuesCell(std::span<const ValueSpec> values, bool words = false);

}  // namespace coopdyn

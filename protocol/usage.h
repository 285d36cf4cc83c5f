// SPDX-License-Identifier: MIT
// How a command is written: what it takes, an example line, and the checks of counts. Pure; any thread.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "protocol/command_table.h"

namespace coopdyn {

/// How many values come before those that repeat.
std::size_t FixedCount(std::span<const ValueSpec> values);
/// The spec of value number `index` (from 0), repeating groups unrolled; null beyond the last.
const ValueSpec* ValueAt(std::span<const ValueSpec> values, std::size_t index);
/// True if `count` values satisfy `values`.
bool CountFits(std::span<const ValueSpec> values, std::size_t count);
/// True if the command takes neither text nor values.
bool TakesNothing(const CommandSpec& spec);
/// The params that a named line gives without brackets: all, or, if data follow, only those that are always
/// there.
std::span<const ValueSpec> BareParams(const CommandSpec& spec);

/// A named line with the names of the values, e.g. `set_velocity [(steps)] linear angular`.
std::string Usage(const CommandSpec& spec);
/// A named line that works, e.g. `set_velocity 0.2 0.5`.
std::string ExampleLine(const CommandSpec& spec);
/// `linear (m/s) and angular (rad/s)`; `nothing` if empty.
std::string ListOf(std::span<const ValueSpec> values);
/// `realtime (0), lockstep (1) or free (2)`.
std::string ListOfEnums(const ValueSpec& value);
/// ` (…)`: what to do instead of giving others than these; empty if that is not said.
std::string Instead(const ValueSpec& value);
/// One cell of the tables of docs/protocol.md, e.g. `[steps], left rad/s`; `–` if empty. What repeats ends
/// with …, in brackets if it is a group. `words`: with the numbers that enum words stand for.
std::string ValuesCell(std::span<const ValueSpec> values, bool words = false);

}  // namespace coopdyn

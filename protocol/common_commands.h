// SPDX-License-Identifier: MIT
// The commands 0 to 9 that every module answers. Pure; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "protocol/command_table.h"

namespace coopdyn {

/// How many commands every table begins with.
inline constexpr std::size_t kCommonCommandCount = 10;

/// True if the command can be subscribed to: a get-command that needs neither text nor values, unless its
/// `no_push` says why not.
bool IsSubscribable(const CommandSpec& spec);

/// The specs of the common commands for a module with the commands `own`, whose subscribable ones become the
/// words that `subscribe` and `unsubscribe` take. The first of them is the module's first reading.
std::vector<CommandSpec> CommonCommands(std::span<const CommandSpec> own);

/// What the replies to actuator commands, `ready` and `get_time` carry before the final time_s and step: the
/// mode, then the length of each reading chosen by `attach`; and those readings.
std::vector<ValueSpec> StepReplyParams();
std::vector<ValueSpec> StepReplyData();
/// The optional param `steps` (at least 1) of actuator commands and `ready`.
ValueSpec StepsParam();
/// The words of the time modes: realtime 0, lockstep 1, free 2.
std::vector<std::pair<std::string, std::int32_t>> ModeWords();

}  // namespace coopdyn

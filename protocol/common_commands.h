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

/// Number of common commands at the front of every table.
inline constexpr std::size_t kCommonCommandCount = 10;

/// True if clients can subscribe to the command: a get-command that needs neither text nor values and has no
/// `no_push`.
bool IsSubscribable(const CommandSpec& spec);

/// The specs of the common commands for a module with the commands `own`. The subscribable ones become the
/// words that `subscribe` and `unsubscribe` accept; the first of them is the module's first reading.
std::vector<CommandSpec> CommonCommands(std::span<const CommandSpec> own);

/// The params and data that replies to actuator commands, `ready` and `get_time` carry before the final
/// time_s and step. Params: the mode, then the length of each reading chosen by `attach`. Data: those
/// readings.
std::vector<ValueSpec> StepReplyParams();
std::vector<ValueSpec> StepReplyData();
/// The optional param `steps` (at least 1) of actuator commands and `ready`.
ValueSpec StepsParam();
/// The words of the time modes: realtime 0, lockstep 1, free 2.
std::vector<std::pair<std::string, std::int32_t>> ModeWords();

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// The named form of a line, `set_velocity 0.2 0.5`. Pure; any thread.
#pragma once

#include <string>
#include <string_view>

#include "protocol/command_table.h"
#include "protocol/message.h"
#include "protocol/text_scan.h"

namespace coopdyn {

/// Reads the rest of a line after `word` by `table`. Returns the request, or an error reply (error != 0): 1
/// and 7 with command -2, what CheckRequest says with the command's own number.
Message ReadNamed(std::string_view word, LineScanner& line, const CommandTable& table);

/// The reply to a line that cannot be read: error 7, command -2.
Message Unreadable(std::string text);

/// Takes one TEXT at the front (quoted, or up to the next blank) into `text`; says what is wrong with it, or
/// nothing.
std::string ReadText(LineScanner& line, std::string& text);

/// Reads a param; says what is wrong with it and what to write instead, or nothing.
std::string ReadParam(std::string_view token, std::int32_t& value);

/// Reads a data value likewise.
std::string ReadData(std::string_view token, double& value);

}  // namespace coopdyn

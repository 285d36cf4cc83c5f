// SPDX-License-Identifier: MIT
// Modules' requests and replies as Bottles, in two forms: words and numbers, as typed in `yarp rpc`, and
// coopdyn's message. Pure functions; any thread.
//
//   set_velocity 0.2 0.5            [ok] 1 12.34 1234.0
//   set_velocty 0.2                 [fail] "unknown command 'set_velocty': did you mean …" 1
//   0 "" 11 () (0.2 0.5)            0 "" 11 (1) (12.34 1234.0)
#pragma once

#include "protocol/codec.h"
#include "protocol/command_table.h"
#include "protocol/message.h"
#include "server/yarp/bottle.h"

namespace coopdyn {

/// True if `bottle` is a message: error text command (params) (data).
bool IsMessageBottle(const Bottle& bottle);
/// Decodes the request in `bottle`. A bottle of words is decoded like a line of text by DecodeText().
Decoded DecodeYarpRequest(const Bottle& bottle, const CommandTable& table);

/// `error text command (params) (data)`.
Bottle MessageBottle(const Message& message);
/// `[ok]`, the text if any, params, data; or `[fail]`, the text and the error number.
Bottle WordsBottle(const Message& reply);
/// `[many]` and one string per line of help.
Bottle HelpBottle(const CommandTable& table);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Requests and replies of modules as Bottles, in two forms: words and numbers, as a person types them in
// `yarp rpc`, and the message of coopdyn. Pure functions; any thread.
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
/// What `bottle` asks for: as DecodeText() answers, whose words the others are.
Decoded DecodeYarpRequest(const Bottle& bottle, const CommandTable& table);

/// `error text command (params) (data)`.
Bottle MessageBottle(const Message& message);
/// `[ok]`, the text if there is one, params, data; or `[fail]`, the text and the error's number.
Bottle WordsBottle(const Message& reply);
/// `[many]` and a line of help each.
Bottle HelpBottle(const CommandTable& table);

}  // namespace coopdyn

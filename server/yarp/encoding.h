// SPDX-License-Identifier: MIT
// Programs of YARP on a module's port: they send Bottles, their requests reach the module as any client's do.
#pragma once

#include "server/net/encoding.h"
#include "server/yarp/network.h"

namespace coopdyn {

/// All encodings of a daemon: that of YARP, then StandardEncodings(). `network` opens what ports are told to
/// connect to, and outlives them.
Encodings EncodingsWithYarp(YarpNetwork& network);

}  // namespace coopdyn

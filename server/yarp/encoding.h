// SPDX-License-Identifier: MIT
// YARP programs on a module's port: they send Bottles, which reach the module like any client's requests.
#pragma once

#include "server/net/encoding.h"
#include "server/yarp/network.h"

namespace coopdyn {

/// All encodings of a daemon: YARP's, then StandardEncodings(). `network` opens the connections that ports
/// are asked to open; it outlives the encodings.
Encodings EncodingsWithYarp(YarpNetwork& network);

}  // namespace coopdyn

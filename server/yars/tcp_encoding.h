// SPDX-License-Identifier: MIT
// The TCP protocol of the public YARS's controller TCPIP, on the port of a robot's module `channel`. A value
// on the wire is a letter and little-endian bytes: d double, i int32, s text, D doubles, I int32s; the last
// three have their count first. Commands are texts: CONFIGURATION, SENSORS, ACTUATORS, RESET, RANDOM SEED,
// MESSAGE, QUIT.
#pragma once

#include "server/net/encoding.h"
#include "server/yars/world.h"

namespace coopdyn {

/// The encoding's kind, chosen by the first five bytes of a text or a list: no other encoding begins with
/// them. Answers invalid input with a text, ERROR and the reason, and closes the connection. `world` must
/// outlive it.
EncodingKind YarsTcpEncodingKind(YarsWorld& world);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// The TCP protocol of the public YARS's controller TCPIP, on the port of a robot's module `channel`. A value
// on the wire is a letter and little-endian bytes: d double, i int32, s text, D doubles, I int32s, the last
// three with their count before. Commands are texts: CONFIGURATION, SENSORS, ACTUATORS, RESET, RANDOM SEED,
// MESSAGE, QUIT.
#pragma once

#include "server/net/encoding.h"
#include "server/yars/world.h"

namespace coopdyn {

/// Its kind: chosen by the first five bytes of a text or a list, which nothing else begins with. What else
/// the client says is answered with a text, ERROR and what is wrong, and the end. `world` outlives it.
EncodingKind YarsTcpEncodingKind(YarsWorld& world);

}  // namespace coopdyn

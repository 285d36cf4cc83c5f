// SPDX-License-Identifier: MIT
// What sensors show in a view (server/sensing/sensor_shapes.h), as bytes for the page: docs/protocol.md.
// Pure; any thread.
#pragma once

#include <cstddef>
#include <string>

#include "server/state/frame.h"

namespace coopdyn {

inline constexpr char kSensorMessageType = 3;  // first byte of the message

/// About 8 MB.
inline constexpr std::size_t kMostSensorVertices = 500'000;

/// The shapes of the sensors of all robots; of each n-th robot if there are more vertices than about `most`.
std::string SensorMessage(const Frame& frame, std::size_t most = kMostSensorVertices);

}  // namespace coopdyn

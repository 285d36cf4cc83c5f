// SPDX-License-Identifier: MIT
// What sensors show in a view (server/sensing/sensor_shapes.h), as bytes for the page: docs/protocol.md.
// Pure; any thread.
#pragma once

#include <string>

#include "server/state/frame.h"

namespace coopdyn {

inline constexpr char kSensorMessageType = 3;  // first byte of the message

/// The shapes of all sensors of all robots.
std::string SensorMessage(const Frame& frame);

}  // namespace coopdyn

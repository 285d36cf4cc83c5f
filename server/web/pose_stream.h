// SPDX-License-Identifier: MIT
// Encodes poses for one viewer in few bytes (docs/protocol.md): the changes since the last message, in units
// of 0.1 mm, and 1/(8192 √2) for the components of quaternions. Pure; one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/state/frame.h"

namespace coopdyn {

class PoseStream {
 public:
  static constexpr double kUnit_m = 1e-4;
  static constexpr int kQuaternionUnits = 8192;
  static constexpr char kType = 2;  // first byte of the message

  /// The message that takes a viewer from the last frame to this one; empty if nothing has changed. `scene`:
  /// number of the frame's scene. A new scene starts with all poses.
  std::string Next(const Frame& frame, std::uint32_t scene);
  /// Makes the next message hold all poses.
  void Restart() {
    bodies_.clear();
    fresh_ = true;
  }

 private:
  /// x, y, z, three components of the quaternion, and the index of the omitted one: the one of largest
  /// magnitude, made positive.
  using Units = std::array<std::int64_t, 7>;
  static Units UnitsOf(const BodyState& body);

  std::vector<Units> bodies_;  // as sent to the viewer
  std::uint32_t scene_ = 0;
  std::uint64_t step_ = 0;
  Nanoseconds time_ = -1;
  bool fresh_ = true;
};

}  // namespace coopdyn

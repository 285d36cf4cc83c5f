// SPDX-License-Identifier: MIT
// Typed ids: a robot id cannot be passed as a target id.
#pragma once

#include <compare>
#include <cstdint>

namespace coopdyn {

/// An id; 0 = none. Ids start at 1 in file order and are not reused until the next reset or load.
template <typename Tag>
struct Id {
  std::uint32_t value = 0;
  constexpr explicit operator bool() const { return value != 0; }
  constexpr auto operator<=>(const Id&) const = default;
};

using RobotId = Id<struct RobotTag>;
using BodyId = Id<struct BodyTag>;
using ObjectId = Id<struct ObjectTag>;
using TargetId = Id<struct TargetTag>;

/// A client's connection; unique during the daemon's life. 0 = no client.
using ClientId = std::uint64_t;

}  // namespace coopdyn

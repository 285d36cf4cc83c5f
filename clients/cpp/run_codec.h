// SPDX-License-Identifier: MIT
// Numbers, poses and names out of the bytes of a recording (docs/formats.md). Pure.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace coopdyn::client {

using Bytes = std::span<const unsigned char>;

/// The lowest byte is the first. @pre at most 8 bytes
std::uint64_t Little(Bytes bytes);
/// The lowest `width` bits as two's complement.
std::int64_t Signed(std::uint64_t bits, int width);
/// @pre 4 bytes
double Single(Bytes bytes);
/// @pre 8 bytes
double Double(Bytes bytes);

using Pose7 = std::array<double, 7>;  // x y z [m], quaternion w x y z

/// The pose of a body out of its 18 bytes (server/record/pose_codec.h), positions in units of 2^exponent µm.
Pose7 BodyPose(Bytes raw, int exponent);
/// The pose of a robot's frame R, from that of its body B, X_WB, and of R in B.
Pose7 RobotPose(const Pose7& X_WB, const Pose7& X_BR);

/// The loaded controller of a robot, in the description of a scene; empty: none.
std::string ControllerIn(Bytes scene, std::int64_t id, const std::string& name, const std::string& type);

}  // namespace coopdyn::client

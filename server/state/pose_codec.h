// SPDX-License-Identifier: MIT
// Encodes a body's pose in 18 bytes, a little-endian number of 144 bits:
//   bits   0…26, 27…53, 54…80   x, y, z of the centre of mass in units of 2^e µm, two's complement
//   bits  81…100, 101…120, 121…140   three components of the quaternion w x y z, in this order: all but
//     the one of largest magnitude, whose sign is made positive; each is round(c √2 (2^19 − 1)), two's
//     complement
//   bits 141…142   the index of the omitted component (0 w, 1 x, 2 y, 3 z)
//   bit  143       the body is frozen
// One e ≥ 0 applies to all bodies of a step: 0, a resolution of 1 µm, while all are within 67 m of the
// origin; then 2 µm up to 134 m, and so on. Orientation error: within 4.7e-6 rad, for a turn about the
// vertical within 1.9e-6 rad. Both are far below what a sensor or picture shows, and differences over one
// step of 10 ms still resolve 0.1 mm/s and 0.4 mrad/s. Pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/state/frame.h"

namespace coopdyn {

inline constexpr std::size_t kPoseBytes = 18;

/// Appends a step's poses to `blob`: one byte e, then kPoseBytes per body. Positions beyond 2^26 · 2^31 µm
/// are clamped; NaN becomes 0.
void EncodePoses(std::span<const BodyState> bodies, std::vector<std::byte>& blob);
/// Sets p, q (normalised), R and, for a frozen body, the sleep counter; velocities are zero. Returns false if
/// `blob` does not hold `bodies.size()` poses.
bool DecodePoses(std::span<const std::byte> blob, std::span<BodyState> bodies);

/// Encodes a channel's position in 40 bits, two's complement in units of 1e-5 rad or m, clamped.
std::uint64_t EncodePosition(double position);
double DecodePosition(std::uint64_t bits);

/// `frame` with its bodies and channels rounded as in a recording, so it is drawn as in playback. Velocities
/// are zero; it has no samples.
FramePtr AsRecorded(const Frame& frame);

}  // namespace coopdyn

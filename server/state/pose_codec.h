// SPDX-License-Identifier: MIT
// The pose of a body in 18 bytes: a little-endian number of 144 bits,
//   bits   0…26, 27…53, 54…80   x, y, z of the centre of mass in units of 2^e µm, two's complement
//   bits  81…100, 101…120, 121…140   three components of the quaternion w x y z, by increasing place: all but
//     the one of largest magnitude, whose sign is made positive; each is round(c √2 (2^19 − 1)), two's
//     complement
//   bits 141…142   the place of the component left out (0 w, 1 x, 2 y, 3 z)
//   bit  143       the body is frozen
// One e ≥ 0 holds for all bodies of a step: 0, so a resolution of 1 µm, as long as all stay within 67 m of
// the origin; then 2 µm up to 134 m, and so on. Orientation: within 4.7e-6 rad, a turn about the vertical
// within 1.9e-6 rad. Both are far below what a sensor or a picture shows; and differences over one step of
// 10 ms still tell 0.1 mm/s and 0.4 mrad/s. Pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/state/frame.h"

namespace coopdyn {

inline constexpr std::size_t kPoseBytes = 18;

/// A step's poses: one byte e, then kPoseBytes for each body, appended to `blob`. What is not finite or
/// beyond 2^26 · 2^31 µm is held at the nearest that can be said.
void EncodePoses(std::span<const BodyState> bodies, std::vector<std::byte>& blob);
/// p, q (normalised), R and, for a frozen body, the sleep counter; velocities are zero. False if `blob` is
/// not `bodies.size()` poses.
bool DecodePoses(std::span<const std::byte> blob, std::span<BodyState> bodies);

/// The position of a channel in 40 bits, two's complement in units of 1e-5 rad or m; beyond that the nearest.
std::uint64_t EncodePosition(double position);
double DecodePosition(std::uint64_t bits);

/// `frame` with its bodies where a recording says that they are, and its channels: what is drawn of it looks
/// the same in playback. Velocities are zero; it has no samples.
FramePtr AsRecorded(const Frame& frame);

}  // namespace coopdyn

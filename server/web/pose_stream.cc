// SPDX-License-Identifier: MIT
#include "server/web/pose_stream.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace coopdyn {

namespace {

void AppendLow(std::string& bytes, std::uint64_t number, int count) {
  for (int i = 0; i < count; ++i) bytes += static_cast<char>(number >> (8 * i) & 0xffU);
}

/// Seven bits per byte, the lowest first; the highest bit says that another byte follows.
void AppendVarint(std::string& bytes, std::uint64_t number) {
  for (; number >= 0x80U; number >>= 7) bytes += static_cast<char>((number & 0x7fU) | 0x80U);
  bytes += static_cast<char>(number);
}

std::uint64_t ZigZag(std::int64_t number) {
  return (static_cast<std::uint64_t>(number) << 1) ^ static_cast<std::uint64_t>(number >> 63);
}

std::int64_t Rounded(double value) {
  constexpr double kMost = 1e12;
  return std::isfinite(value) ? std::llround(std::clamp(value, -kMost, kMost)) : 0;
}

}  // namespace

PoseStream::Units PoseStream::UnitsOf(const BodyState& body) {
  Units units{};
  for (int i = 0; i < 3; ++i) units[static_cast<std::size_t>(i)] = Rounded(body.p_WB[i] / kUnit_m);
  const std::array<double, 4>& q = body.q_WB;
  std::size_t largest = 0;
  for (std::size_t i = 1; i < 4; ++i) {
    if (std::abs(q[i]) > std::abs(q[largest])) largest = i;
  }
  const double sign = q[largest] < 0 ? -1 : 1;
  std::size_t next = 3;
  for (std::size_t i = 0; i < 4; ++i) {
    if (i != largest) units[next++] = Rounded(sign * q[i] * std::numbers::sqrt2 * kQuaternionUnits);
  }
  units[6] = static_cast<std::int64_t>(largest);
  return units;
}

std::string PoseStream::Next(const Frame& frame, std::uint32_t scene) {
  const bool anew = fresh_ || scene != scene_ || bodies_.size() != frame.bodies.size();
  std::string changes;
  if (anew) bodies_.assign(frame.bodies.size(), Units{});
  std::uint64_t skipped = 0;
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const Units now = UnitsOf(frame.bodies[i]);
    Units& had = bodies_[i];
    unsigned mask = now[6] != had[6] ? 0x40U : 0U;
    for (std::size_t k = 0; k < 6; ++k) {
      // If another component is omitted, the three are not comparable: send them all.
      if (now[k] != had[k] || (mask != 0 && k >= 3)) mask |= 1U << k;
    }
    if (mask == 0 && !anew) {
      ++skipped;
      continue;
    }
    AppendVarint(changes, skipped);
    skipped = 0;
    changes += static_cast<char>(mask);
    if ((mask & 0x40U) != 0) changes += static_cast<char>(now[6]);
    for (std::size_t k = 0; k < 6; ++k) {
      if ((mask >> k & 1U) == 0) continue;
      const bool whole = (mask & 0x40U) != 0 && k >= 3;
      AppendVarint(changes, ZigZag(whole ? now[k] : now[k] - had[k]));
    }
    had = now;
  }
  if (!anew && changes.empty() && frame.time == time_ && frame.step == step_) return {};
  scene_ = scene;
  step_ = frame.step;
  time_ = frame.time;
  fresh_ = false;
  std::string message;
  message += kType;
  message += static_cast<char>(anew ? 1 : 0);
  AppendLow(message, scene, 4);
  AppendLow(message, frame.step, 8);
  AppendLow(message, std::bit_cast<std::uint64_t>(frame.time_s()), 8);
  return message + changes;
}

}  // namespace coopdyn

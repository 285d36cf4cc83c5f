// SPDX-License-Identifier: MIT
#include "server/state/pose_codec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>

namespace coopdyn {

namespace {

constexpr std::int64_t kMostUnits = (std::int64_t{1} << 26) - 1;
constexpr int kMaxExponent = 31;
constexpr std::int64_t kMostTurn = (std::int64_t{1} << 19) - 1;
constexpr double kTurnScale = std::numbers::sqrt2 * static_cast<double>(kMostTurn);
constexpr double kPositionUnit = 1e-5;              // rad or m
constexpr double kMostAngleUnits = 549755813887.0;  // 2^39 − 1
constexpr std::uint64_t kMask27 = (std::uint64_t{1} << 27) - 1;
constexpr std::uint64_t kMask20 = (std::uint64_t{1} << 20) - 1;

/// The least e whose units can represent all finite positions.
int ExponentOf(std::span<const BodyState> bodies) {
  double farthest_m = 0;
  for (const BodyState& body : bodies) {
    for (const double p_m : body.p_WB) {
      if (std::isfinite(p_m)) farthest_m = std::max(farthest_m, std::abs(p_m));
    }
  }
  int exponent = 0;
  while (exponent < kMaxExponent &&
         std::nearbyint(std::ldexp(farthest_m * 1e6, -exponent)) > static_cast<double>(kMostUnits)) {
    ++exponent;
  }
  return exponent;
}

/// `value` rounded and clamped to ±most; 0 for NaN.
std::uint64_t Round(double value, std::int64_t most) {
  const auto limit = static_cast<double>(most);
  if (std::isnan(value)) return 0;
  return static_cast<std::uint64_t>(std::llrint(std::clamp(value, -limit, limit)));
}

std::int64_t Signed(std::uint64_t bits, int width) {
  const std::uint64_t sign = std::uint64_t{1} << (width - 1);
  return static_cast<std::int64_t>((bits ^ sign) - sign);
}

void PutLow(std::uint64_t number, std::size_t count, std::byte* at) {
  for (std::size_t i = 0; i < count; ++i) at[i] = static_cast<std::byte>(number >> (8 * i));
}

std::uint64_t GetLow(const std::byte* at, std::size_t count) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < count; ++i) number |= std::to_integer<std::uint64_t>(at[i]) << (8 * i);
  return number;
}

struct Turn {
  std::array<std::uint64_t, 3> parts{};  // in 20 bits each
  std::uint64_t left_out = 0;
};

Turn EncodeTurn(const std::array<double, 4>& q) {
  const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  Turn turn;
  if (!(square > 0) || !std::isfinite(square)) return turn;
  std::size_t largest = 0;
  for (std::size_t i = 1; i < 4; ++i) {
    if (std::abs(q[i]) > std::abs(q[largest])) largest = i;
  }
  const double scale = std::copysign(kTurnScale / std::sqrt(square), q[largest]);
  std::size_t part = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (i != largest) turn.parts[part++] = Round(q[i] * scale, kMostTurn) & kMask20;
  }
  turn.left_out = largest;
  return turn;
}

std::array<double, 4> DecodeTurn(const Turn& turn) {
  std::array<double, 4> q{};
  double square = 0;
  std::size_t part = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (i == turn.left_out) continue;
    q[i] = static_cast<double>(Signed(turn.parts[part++], 20)) / kTurnScale;
    square += q[i] * q[i];
  }
  q[turn.left_out] = std::sqrt(std::max(0.0, 1 - square));
  const double norm = std::sqrt(square + q[turn.left_out] * q[turn.left_out]);
  for (double& component : q) component /= norm;
  return q;
}

}  // namespace

void EncodePoses(std::span<const BodyState> bodies, std::vector<std::byte>& blob) {
  const int exponent = ExponentOf(bodies);
  const double units_per_m = std::ldexp(1e6, -exponent);
  const std::size_t start = blob.size();
  blob.resize(start + 1 + bodies.size() * kPoseBytes);
  std::byte* at = blob.data() + start;
  *at++ = static_cast<std::byte>(exponent);
  for (const BodyState& body : bodies) {
    const std::uint64_t x = Round(body.p_WB.x() * units_per_m, kMostUnits) & kMask27;
    const std::uint64_t y = Round(body.p_WB.y() * units_per_m, kMostUnits) & kMask27;
    const std::uint64_t z = Round(body.p_WB.z() * units_per_m, kMostUnits) & kMask27;
    const Turn turn = EncodeTurn(body.q_WB);
    const std::uint64_t frozen = body.frozen() ? 1 : 0;
    PutLow(x | y << 27 | z << 54, 8, at);
    PutLow(z >> 10 | turn.parts[0] << 17 | turn.parts[1] << 37 | turn.parts[2] << 57, 8, at + 8);
    PutLow(turn.parts[2] >> 7 | turn.left_out << 13 | frozen << 15, 2, at + 16);
    at += kPoseBytes;
  }
}

bool DecodePoses(std::span<const std::byte> blob, std::span<BodyState> bodies) {
  if (blob.empty() || blob.size() - 1 != bodies.size() * kPoseBytes) return false;
  const int exponent = std::to_integer<int>(blob[0]);
  if (exponent > kMaxExponent) return false;
  const double unit_m = std::ldexp(1.0, exponent);
  const std::byte* at = blob.data() + 1;
  for (BodyState& body : bodies) {
    const std::uint64_t low = GetLow(at, 8), middle = GetLow(at + 8, 8), high = GetLow(at + 16, 2);
    at += kPoseBytes;
    const std::uint64_t z = (low >> 54 | middle << 10) & kMask27;
    body = BodyState();
    body.p_WB.x() = static_cast<double>(Signed(low & kMask27, 27)) * unit_m / 1e6;
    body.p_WB.y() = static_cast<double>(Signed(low >> 27 & kMask27, 27)) * unit_m / 1e6;
    body.p_WB.z() = static_cast<double>(Signed(z, 27)) * unit_m / 1e6;
    Turn turn;
    turn.parts = {middle >> 17 & kMask20, middle >> 37 & kMask20, (middle >> 57 | high << 7) & kMask20};
    turn.left_out = high >> 13 & 3;
    body.q_WB = DecodeTurn(turn);
    const Matrix3 R = body.orientation().toRotationMatrix();
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 3; ++column) {
        body.R_WB[3 * row + column] = R(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
      }
    }
    if ((high >> 15 & 1) != 0) body.sleep_counter = BodyState::kFrozen;
  }
  return true;
}

std::uint64_t EncodePosition(double position) {
  const double units = std::isnan(position) ? 0 : position / kPositionUnit;
  return static_cast<std::uint64_t>(std::llrint(std::clamp(units, -kMostAngleUnits, kMostAngleUnits)));
}

double DecodePosition(std::uint64_t bits) {
  constexpr std::uint64_t kSign = std::uint64_t{1} << 39;
  return static_cast<double>(static_cast<std::int64_t>((bits ^ kSign) - kSign)) * kPositionUnit;
}

FramePtr AsRecorded(const Frame& frame) {
  auto recorded = std::make_shared<Frame>();
  recorded->epoch = frame.epoch;
  recorded->step = frame.step;
  recorded->revision = frame.revision;
  recorded->time = frame.time;
  recorded->step_length = frame.step_length;
  recorded->seed = frame.seed;
  recorded->scene = frame.scene;
  std::vector<std::byte> blob;
  EncodePoses(frame.bodies, blob);
  recorded->bodies.resize(frame.bodies.size());
  DecodePoses(blob, recorded->bodies);
  recorded->channels = frame.channels;
  for (ChannelState& channel : recorded->channels)
    channel.position = DecodePosition(EncodePosition(channel.position));
  return recorded;
}

}  // namespace coopdyn

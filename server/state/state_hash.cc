// SPDX-License-Identifier: MIT
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>

#include "server/state/frame.h"

namespace coopdyn {

namespace {

/// XXH3-64 over 8-byte words, each little-endian on any machine.
class WordHasher {
 public:
  WordHasher() { XXH3_64bits_reset(&state_); }

  void Add(std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte) {
      buffer_[size_++] = static_cast<unsigned char>(word >> (8 * byte));
    }
    if (size_ == buffer_.size()) Flush();
  }
  void Add(double number) { Add(std::bit_cast<std::uint64_t>(number)); }
  template <typename Numbers>
  void AddAll(const Numbers& numbers) {
    for (const double number : numbers) Add(number);
  }
  std::uint64_t Digest() {
    Flush();
    return XXH3_64bits_digest(&state_);
  }

 private:
  void Flush() {
    XXH3_64bits_update(&state_, buffer_.data(), size_);
    size_ = 0;
  }

  XXH3_state_t state_;
  std::array<unsigned char, 1024> buffer_;
  std::size_t size_ = 0;
};

}  // namespace

std::uint64_t StateHash(const Frame& frame) {
  if (frame.recorded_hash) return *frame.recorded_hash;
  WordHasher hasher;
  hasher.Add(frame.step);
  hasher.Add(static_cast<std::uint64_t>(frame.time));
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const BodyState& body = frame.bodies[i];
    hasher.Add(std::uint64_t{frame.scene->body_ids[i].value});
    hasher.AddAll(body.p_WB);
    hasher.AddAll(body.q_WB);
    hasher.AddAll(body.R_WB);
    hasher.AddAll(body.v_WB);
    hasher.AddAll(body.w_WB);
    hasher.Add(body.sleep_counter);
  }
  for (const RobotState& robot : frame.robots) hasher.AddAll(robot.setpoint_rad_s);
  hasher.Add(frame.solver_seed);
  return hasher.Digest();
}

std::string HashText(std::uint64_t hash) {
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; hash >>= 4) text[i] = "0123456789abcdef"[hash & 15];
  return text;
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "server/state/frame.h"

namespace coopdyn {

namespace {

/// XXH3-64 of bytes and 8-byte words, little-endian on every machine.
class WordHasher {
 public:
  WordHasher() { XXH3_64bits_reset(&state_); }

  void Add(std::uint64_t word) { AddWords(&word, 1); }
  /// Adds `count` numbers of 8 bytes each, as stored in memory.
  void AddWords(const void* words, std::size_t count) {
    if (size_ + 8 * count > buffer_.size()) Flush();
    if constexpr (std::endian::native == std::endian::little) {
      std::memcpy(buffer_.data() + size_, words, 8 * count);
      size_ += 8 * count;
    } else {
      for (std::size_t i = 0; i < count; ++i) {
        std::uint64_t word = 0;
        std::memcpy(&word, static_cast<const unsigned char*>(words) + 8 * i, 8);
        for (int byte = 0; byte < 8; ++byte) {
          buffer_[size_++] = static_cast<unsigned char>(word >> (8 * byte));
        }
      }
    }
  }
  void AddByte(unsigned char byte) {
    if (size_ == buffer_.size()) Flush();
    buffer_[size_++] = byte;
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
  std::array<unsigned char, 4096> buffer_;
  std::size_t size_ = 0;
};

// A body is stored in hashing order: position 3, quaternion 4, matrix 9, velocities 3 and 3, counter.
constexpr std::size_t kBodyWords = 23;
static_assert(sizeof(BodyState) == 8 * kBodyWords && offsetof(BodyState, q_WB) == 24 &&
              offsetof(BodyState, R_WB) == 56 && offsetof(BodyState, v_WB) == 128 &&
              offsetof(BodyState, w_WB) == 152 && offsetof(BodyState, sleep_counter) == 176);

}  // namespace

std::uint64_t StateHash(const Frame& frame) {
  if (frame.recorded_hash) return *frame.recorded_hash;
  WordHasher hasher;
  hasher.Add(frame.step);
  hasher.Add(static_cast<std::uint64_t>(frame.time));
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    hasher.Add(std::uint64_t{frame.scene->body_ids[i].value});
    hasher.AddWords(&frame.bodies[i], kBodyWords);
  }
  for (const ChannelState& channel : frame.channels) {
    hasher.AddByte(static_cast<unsigned char>(channel.setpoint.mode));
    hasher.AddWords(&channel.setpoint.reference, 1);
  }
  for (const JointControl& control : frame.controls) hasher.AddWords(&control, JointControl::kDoubles);
  for (const DriveTrainState& train : frame.drive_trains) hasher.AddWords(&train, DriveTrainState::kDoubles);
  for (const double value : frame.measured) hasher.AddWords(&value, 1);
  hasher.Add(frame.solver_seed);
  return hasher.Digest();
}

std::string HashText(std::uint64_t hash) {
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; hash >>= 4) text[i] = "0123456789abcdef"[hash & 15];
  return text;
}

}  // namespace coopdyn

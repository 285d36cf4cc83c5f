// SPDX-License-Identifier: MIT
#include "tests/server/physics/simulation_scene.h"

#include <cstring>

namespace coopdyn {

namespace {

class Digest {
 public:
  void Add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001b3 + (value_ >> 29); }
  void Add(double number) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof(bits));
    Add(bits);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325;
};

}  // namespace

std::uint64_t WholeHash(const Frame& frame) {
  Digest digest;
  digest.Add(StateHash(frame));
  digest.Add(frame.seed);
  digest.Add(static_cast<std::uint64_t>(frame.step_length));
  for (const ChannelState& channel : frame.channels) {
    digest.Add(channel.position);
    digest.Add(channel.velocity);
  }
  for (const std::uint8_t commanded : frame.commanded) digest.Add(std::uint64_t{commanded});
  for (const SentMessage& sent : frame.messages) {
    digest.Add(std::uint64_t{sent.robot});
    digest.Add(sent.step);
    digest.Add(std::uint64_t{sent.message.count});
    for (const double value : sent.message.values) digest.Add(value);
  }
  return digest.value();
}

std::vector<std::uint64_t> WholeHashes(SteppedSimulation& simulation, int count) {
  std::vector<std::uint64_t> hashes = {WholeHash(*simulation->frame())};
  for (int i = 0; i < count; ++i) hashes.push_back(WholeHash(*simulation.Step()));
  return hashes;
}

}  // namespace coopdyn

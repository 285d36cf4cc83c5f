// SPDX-License-Identifier: MIT
// The state hash is a contract: other tools compute it from recordings.
#include <gtest/gtest.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "server/state/frame.h"

namespace coopdyn {
namespace {

/// Bytes in the order of docs/formats.md ("The state hash"), collected without the code under test.
struct Bytes {
  std::string text;
  template <typename T>
  Bytes& operator<<(T value) {
    static_assert(sizeof(T) == 8 || sizeof(T) == 1);
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw, raw + sizeof(T));
    text.append(raw, sizeof(T));
    return *this;
  }
};

std::unique_ptr<Frame> TestFrame(std::size_t bodies, std::size_t channels) {
  auto frame = std::make_unique<Frame>();
  auto scene = std::make_shared<Scene>();
  frame->step = 7;
  frame->time = 70'000'000;
  frame->solver_seed = 99;
  frame->bodies.resize(bodies);
  for (std::size_t i = 0; i < bodies; ++i) {
    scene->body_ids.push_back(BodyId{static_cast<std::uint32_t>(2 * i + 1)});
    const double x = static_cast<double>(i) + 0.1;
    BodyState& body = frame->bodies[i];
    body.p_WB = {x, -x, 2 * x};
    body.q_WB = {x, 2, 3, 4};
    for (std::size_t k = 0; k < 9; ++k) body.R_WB[k] = x + static_cast<double>(k);
    body.v_WB = {5 * x, 6, 7};
    body.w_WB = {8 * x, 9, -0.0};
    body.sleep_counter = i;
  }
  for (std::size_t i = 0; i < channels; ++i) {
    frame->channels.push_back({1, 2, 3, {0.5 + static_cast<double>(i), ControlMode::kPosition}});
  }
  frame->scene = scene;
  return frame;
}

class HashOfSize : public testing::TestWithParam<int> {};

TEST_P(HashOfSize, IsXxh3OverTheStatedWords) {
  const auto n = static_cast<std::size_t>(GetParam());
  const auto frame = TestFrame(n, n / 3);
  Bytes bytes;
  bytes << frame->step << frame->time;
  for (std::size_t i = 0; i < n; ++i) {
    const BodyState& b = frame->bodies[i];
    bytes << std::uint64_t{frame->scene->body_ids[i].value};
    for (int k = 0; k < 3; ++k) bytes << b.p_WB[k];
    for (const double q : b.q_WB) bytes << q;
    for (const double r : b.R_WB) bytes << r;
    for (int k = 0; k < 3; ++k) bytes << b.v_WB[k];
    for (int k = 0; k < 3; ++k) bytes << b.w_WB[k];
    bytes << b.sleep_counter;
  }
  for (const ChannelState& channel : frame->channels) bytes << char{1} << channel.setpoint.reference;
  bytes << frame->solver_seed;
  EXPECT_EQ(StateHash(*frame), XXH3_64bits(bytes.text.data(), bytes.text.size()));
}

// From a few bytes to many blocks of the algorithm.
INSTANTIATE_TEST_SUITE_P(Bodies, HashOfSize, testing::Values(0, 1, 3, 10, 100));

TEST(Hash, EveryPartOfTheStateCounts) {
  const std::vector<std::function<void(Frame&)>> changes = {
      [](Frame& f) { ++f.step; },
      [](Frame& f) { ++f.time; },
      [](Frame& f) { ++f.solver_seed; },
      [](Frame& f) { f.bodies[1].p_WB.y() = std::nextafter(f.bodies[1].p_WB.y(), 100); },
      [](Frame& f) { f.bodies[1].q_WB[3] += 1e-15; },
      [](Frame& f) { f.bodies[1].R_WB[8] += 1e-14; },
      [](Frame& f) { f.bodies[1].v_WB.z() += 1e-14; },
      [](Frame& f) { f.bodies[1].w_WB.z() = 0.0; },  // was −0: raw bits count
      [](Frame& f) { ++f.bodies[1].sleep_counter; },
      [](Frame& f) { f.channels[0].setpoint.reference += 1e-15; },
      [](Frame& f) { f.channels[0].setpoint.mode = ControlMode::kDirect; }};
  const std::uint64_t hash = StateHash(*TestFrame(3, 1));
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const auto frame = TestFrame(3, 1);
    changes[i](*frame);
    EXPECT_NE(StateHash(*frame), hash) << i;
  }
}

TEST(Hash, RevisionAndReadingsDoNotCount) {
  const auto frame = TestFrame(3, 1);
  frame->revision = 5;
  frame->channels[0].position = 1e3;
  frame->channels[0].effort = 5;
  EXPECT_EQ(StateHash(*frame), StateHash(*TestFrame(3, 1)));
}

TEST(Hash, TextIsSixteenLowerCaseHexDigits) {
  EXPECT_EQ(HashText(0), "0000000000000000");
  EXPECT_EQ(HashText(0x0123456789ABCDEF), "0123456789abcdef");
}

}  // namespace
}  // namespace coopdyn

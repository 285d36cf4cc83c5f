// SPDX-License-Identifier: MIT
#include "server/state/pose_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "record_fixture.h"

namespace coopdyn {
namespace {

std::vector<BodyState> RoundTrip(const std::vector<BodyState>& bodies) {
  std::vector<std::byte> blob;
  EncodePoses(bodies, blob);
  EXPECT_EQ(blob.size(), 1 + kPoseBytes * bodies.size());
  std::vector<BodyState> read(bodies.size());
  EXPECT_TRUE(DecodePoses(blob, read));
  return read;
}

double AngleBetween(const BodyState& a, const BodyState& b) {
  const Quaternion turn = a.orientation().normalized().conjugate() * b.orientation();
  return 2 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
}

std::vector<BodyState> RandomBodies(int count, double scale) {
  FrameMaker maker(nullptr);
  std::vector<BodyState> bodies;
  for (int i = 0; i < count; ++i) {
    bodies.push_back(maker.Body());
    bodies.back().p_WB *= scale;
  }
  return bodies;
}

TEST(PoseCodecTest, PositionsAreWithinHalfAMicrometreNearTheOrigin) {
  const std::vector<BodyState> bodies = RandomBodies(2000, 6.7);  // ±67 m
  const std::vector<BodyState> read = RoundTrip(bodies);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    EXPECT_LE((read[i].p_WB - bodies[i].p_WB).cwiseAbs().maxCoeff(), 0.5e-6 + 1e-12);
  }
}

TEST(PoseCodecTest, FartherOutPositionsAreWithinHalfOfTheDoubledUnit) {
  for (int exponent = 1; exponent <= 31; ++exponent) {
    const double far_m = std::ldexp(67.0, exponent);
    const std::vector<BodyState> bodies = RandomBodies(50, far_m / 10);
    std::vector<BodyState> all = bodies;
    all.emplace_back().p_WB.x() = -far_m;
    const std::vector<BodyState> read = RoundTrip(all);
    const double bound_m = std::ldexp(0.5e-6, exponent) * (1 + 1e-9);
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_LE((read[i].p_WB - all[i].p_WB).cwiseAbs().maxCoeff(), bound_m) << exponent;
    }
  }
}

TEST(PoseCodecTest, OrientationsAreWithinTheirBound) {
  const std::vector<BodyState> bodies = RandomBodies(20000, 1);
  const std::vector<BodyState> read = RoundTrip(bodies);
  double largest_rad = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    largest_rad = std::max(largest_rad, AngleBetween(bodies[i], read[i]));
    EXPECT_NEAR(read[i].orientation().norm(), 1, 1e-15);
  }
  EXPECT_LE(largest_rad, 4.7e-6);
  EXPECT_GE(largest_rad, 1e-6);  // the bound is tight
}

TEST(PoseCodecTest, TurnsAboutTheVerticalAreWithinTheirNarrowerBound) {
  std::vector<BodyState> bodies(10000);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double half_rad = 3.2 * (static_cast<double>(i) / 5000 - 1);
    bodies[i].q_WB = {std::cos(half_rad), 0, 0, std::sin(half_rad)};
  }
  const std::vector<BodyState> read = RoundTrip(bodies);
  for (std::size_t i = 0; i < bodies.size(); ++i) EXPECT_LE(AngleBetween(bodies[i], read[i]), 1.9e-6);
}

TEST(PoseCodecTest, EachComponentCanBeTheLargestWithEitherSign) {
  std::vector<BodyState> bodies(8);
  for (std::size_t i = 0; i < 8; ++i) {
    bodies[i].q_WB = {0.1, -0.2, 0.3, -0.1};
    bodies[i].q_WB[i / 2] = i % 2 == 0 ? 0.9 : -0.9;
    const double norm = bodies[i].orientation().norm();
    for (double& component : bodies[i].q_WB) component /= norm;
  }
  const std::vector<BodyState> read = RoundTrip(bodies);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_LE(AngleBetween(bodies[i], read[i]), 4.7e-6) << i;
}

TEST(PoseCodecTest, TheMatrixIsThatOfTheQuaternionAndSpeedsAreZero) {
  const std::vector<BodyState> read = RoundTrip(RandomBodies(10, 1));
  for (const BodyState& body : read) {
    const Matrix3 R = body.orientation().toRotationMatrix();
    for (int i = 0; i < 9; ++i) EXPECT_EQ(body.R_WB[static_cast<std::size_t>(i)], R(i / 3, i % 3));
    EXPECT_TRUE(body.v_WB.isZero(0));
    EXPECT_TRUE(body.w_WB.isZero(0));
  }
}

TEST(PoseCodecTest, FrozenBodiesStayFrozen) {
  std::vector<BodyState> bodies = RandomBodies(3, 1);
  bodies[1].sleep_counter = BodyState::kFrozen;
  const std::vector<BodyState> read = RoundTrip(bodies);
  EXPECT_FALSE(read[0].frozen());
  EXPECT_TRUE(read[1].frozen());
  EXPECT_FALSE(read[2].frozen());
}

TEST(PoseCodecTest, TheLayoutIsTheDocumentedOne) {
  std::vector<BodyState> bodies(1);
  bodies[0].p_WB = {1e-6, -2e-6, 3e-6};
  bodies[0].q_WB = {0, 0, 0, 1};
  bodies[0].sleep_counter = BodyState::kFrozen;
  std::vector<std::byte> blob;
  EncodePoses(bodies, blob);
  // bit by bit: x = 1, y = −2, z = 3, three zeros, place 3, frozen
  std::array<bool, 144> bits{};
  for (std::size_t i = 0; i < 144; ++i) {
    bits[i] = (std::to_integer<unsigned>(blob[1 + i / 8]) >> (i % 8) & 1U) != 0;
  }
  std::array<bool, 144> expected{};
  expected[0] = true;
  for (std::size_t i = 28; i < 54; ++i) expected[i] = true;
  expected[54] = expected[55] = true;
  expected[141] = expected[142] = expected[143] = true;
  EXPECT_EQ(bits, expected);
  EXPECT_EQ(blob[0], std::byte{0});
}

TEST(PoseCodecTest, WhatIsNotFiniteIsHeld) {
  std::vector<BodyState> bodies(4);
  bodies[0].p_WB = {std::numeric_limits<double>::infinity(), std::nan(""), 1};
  bodies[1].q_WB = {std::nan(""), 0, 0, 0};
  bodies[2].q_WB = {0, 0, 0, 0};
  bodies[3].p_WB.x() = 1e300;
  const std::vector<BodyState> read = RoundTrip(bodies);
  for (const BodyState& body : read) {
    EXPECT_TRUE(body.p_WB.allFinite());
    EXPECT_NEAR(body.orientation().norm(), 1, 1e-12);
  }
  EXPECT_GT(read[0].p_WB.x(), 1e11);
  EXPECT_GT(read[3].p_WB.x(), 1e11);
}

TEST(PoseCodecTest, AWrongLengthIsRefused) {
  std::vector<std::byte> blob;
  EncodePoses(RandomBodies(3, 1), blob);
  std::vector<BodyState> bodies(3);
  EXPECT_FALSE(DecodePoses(std::span(blob).first(blob.size() - 1), bodies));
  EXPECT_FALSE(DecodePoses({}, bodies));
  bodies.resize(4);
  EXPECT_FALSE(DecodePoses(blob, bodies));
  bodies.resize(3);
  blob[0] = std::byte{32};  // beyond the largest unit
  EXPECT_FALSE(DecodePoses(blob, bodies));
}

TEST(PoseCodecTest, AnyBytesOfTheRightLengthGiveSomePose) {
  std::mt19937 random(5);
  std::vector<std::byte> blob(1 + 20 * kPoseBytes);
  std::vector<BodyState> bodies(20);
  for (int round = 0; round < 200; ++round) {
    for (std::byte& byte : blob) byte = static_cast<std::byte>(random());
    blob[0] &= std::byte{31};
    ASSERT_TRUE(DecodePoses(blob, bodies));
    for (const BodyState& body : bodies) {
      EXPECT_TRUE(body.p_WB.allFinite());
      EXPECT_NEAR(body.orientation().norm(), 1, 1e-12);
    }
  }
}

}  // namespace
}  // namespace coopdyn

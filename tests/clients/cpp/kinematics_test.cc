// SPDX-License-Identifier: MIT
// Forward and inverse kinematics of serial chains made by hand. No daemon.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "clients/cpp/chain.h"
#include "clients/cpp/error.h"

namespace coopdyn::client {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

Eigen::Isometry3d At(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

/// Two hinges about z, links of 0.4 and 0.3 m along x.
Chain Planar(double lower = -kInf, double upper = kInf) {
  return Chain({{{0, 0, 0}, {0, 0, 1}, false, lower, upper}, {{0.4, 0, 0}, {0, 0, 1}, false, lower, upper}},
               At(0.7, 0, 0));
}

/// Shoulder, elbow and wrist of a 7-axis arm that stands upright: axes z y z y z y z.
Chain SevenAxes() {
  const double heights[] = {0.1, 0.3, 0.45, 0.63, 0.8, 0.95, 1.02};
  const double limits[] = {3.1, 2.0, 3.1, 2.0, 3.1, 2.0, 6.2};
  std::vector<ChainJoint> joints;
  for (int i = 0; i < 7; ++i) {
    const Eigen::Vector3d axis = i % 2 == 0 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
    joints.push_back({{0, 0, heights[i]}, axis, false, -limits[i], limits[i]});
  }
  return Chain(joints, At(0, 0, 1.1));
}

TEST(ChainTest, TwoHingesInAPlaneFollowTheClosedForm) {
  for (const auto& [q1, q2] : {std::pair{0.0, 0.0}, {0.3, 0.5}, {-1.2, 2.0}, {3.0, -0.4}}) {
    Eigen::Isometry3d expected =
        At(0.4 * std::cos(q1) + 0.3 * std::cos(q1 + q2), 0.4 * std::sin(q1) + 0.3 * std::sin(q1 + q2), 0);
    expected.rotate(Eigen::AngleAxisd(q1 + q2, Eigen::Vector3d::UnitZ()));
    EXPECT_TRUE(Planar().forward({q1, q2}).isApprox(expected, 1e-14));
  }
}

TEST(ChainTest, ASliderAfterAHingeSlidesAlongTheTurnedAxis) {
  const Chain chain({{{0, 0, 0}, {0, 0, 2}}, {{0, 0, 0}, {1, 0, 0}, true}}, At(0.1, 0, 0.5));
  EXPECT_TRUE(
      chain.forward({std::numbers::pi / 2, 0.2}).translation().isApprox(Eigen::Vector3d(0, 0.3, 0.5), 1e-14));
}

TEST(ChainTest, ASliderBeforeAHingeCarriesItsAxis) {
  const Chain chain({{{0, 0, 0}, {0, 0, 1}, true}, {{0, 0, 0}, {0, 1, 0}}}, At(0.5, 0, 0));
  const Eigen::Vector3d p = chain.forward({0.3, std::numbers::pi / 2}).translation();
  EXPECT_LT((p - Eigen::Vector3d(0, 0, -0.2)).norm(), 1e-15);
}

TEST(ChainTest, RandomPosturesOfSevenAxesAreFoundAgain) {
  const Chain chain = SevenAxes();
  std::mt19937 dice(1);
  for (int k = 0; k < 40; ++k) {
    std::vector<double> q;
    for (const ChainJoint& joint : chain.joints())
      q.push_back(std::uniform_real_distribution(joint.lower, joint.upper)(dice));
    const Eigen::Isometry3d pose = chain.forward(q);
    const std::vector<double> found = chain.inverse(pose, std::vector<double>(7, 0.1));
    EXPECT_LT((chain.forward(found).matrix() - pose.matrix()).norm(), 1e-6);
    for (std::size_t i = 0; i < 7; ++i) {
      EXPECT_GE(found[i], chain.joints()[i].lower);
      EXPECT_LE(found[i], chain.joints()[i].upper);
    }
  }
}

TEST(ChainTest, ThePostureNearestToTheStartIsKept) {
  for (const double elbow : {0.8, -0.8}) {
    const std::vector<double> q = Planar().inverse(Planar().forward({0.3, elbow}), {0.25, elbow * 0.9});
    EXPECT_NEAR(q[0], 0.3, 1e-6);
    EXPECT_NEAR(q[1], elbow, 1e-6);
  }
}

TEST(ChainTest, APositionAloneLeavesTheDirectionFree) {
  const Eigen::Vector3d p = {0.2, 0.5, 0};
  EXPECT_LT((Planar().forward(Planar().inverse(p, {0.1, 0.1})).translation() - p).norm(), 1e-6);
}

TEST(ChainTest, HalfATurnOfTheToolIsFound) {
  const Chain chain = SevenAxes();
  const std::vector<double> q0 = {0.3, 0.6, 0.2, 0.9, 0.1, -0.7, 0.0};
  std::vector<double> turned = q0;
  turned[6] = std::numbers::pi;
  const Eigen::Isometry3d pose = chain.forward(turned);
  EXPECT_LT((chain.forward(chain.inverse(pose, q0)).matrix() - pose.matrix()).norm(), 1e-6);
}

TEST(ChainTest, WhatIsOutOfReachIsSaidWithTheDistance) {
  try {
    Planar().inverse(Eigen::Vector3d(1, 0, 0));
    FAIL() << "it was found";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), 4);
    EXPECT_NE(e.text().find("the nearest is 0.3 m off"), std::string::npos) << e.text();
  }
}

TEST(ChainTest, APoseThatLimitsForbidIsRefused) {
  EXPECT_THROW(Planar(0, 0.5).inverse(Eigen::Vector3d(0, -0.5, 0)), Error);
}

TEST(ChainTest, AWrongNumberOfValuesIsSaid) {
  try {
    Planar().forward({1, 2, 3});
    FAIL() << "it was taken";
  } catch (const Error& e) {
    EXPECT_EQ(e.text(), "q has 3 values, the chain 2 joints");
  }
}

}  // namespace
}  // namespace coopdyn::client

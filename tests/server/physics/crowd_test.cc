// SPDX-License-Identifier: MIT
// Crowds: robots that push each other all the time stay upright, do not sink, do not explode.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <tuple>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn {
namespace {

/// Robots on a square grid within four walls, `area_m2` each.
class CrowdScene : public PhysicsScene {
 public:
  CrowdScene(Fidelity of, bool small, int robots, double area_m2) {
    fidelity = of;
    robot_model = small ? SmallRobot() : TestRobot();
    side_m_ = std::sqrt(area_m2 * robots);
    const int columns = static_cast<int>(std::ceil(std::sqrt(robots)));
    const double pitch = side_m_ / columns;
    for (int i = 0; i < robots; ++i) {
      AddRobot((i % columns + 0.5) * pitch - side_m_ / 2, (i / columns + 0.5) * pitch - side_m_ / 2, 0.7 * i);
    }
    for (int k = 0; k < 4; ++k) {
      const double angle = k * std::acos(0.0), middle = side_m_ / 2 + 0.05;
      Add(Box{Vector3(0.1, side_m_ + 0.2, 0.5)},
          {{middle * std::cos(angle), middle * std::sin(angle), 0.25}, FromRollPitchYaw(0, 0, angle)});
    }
  }

  /// Every robot gets new random wheel speeds.
  void DriveAtRandom(double fastest_rad_s) {
    for (int i = 0; i < robot_count(); ++i) {
      const double left = Uniform() * fastest_rad_s;
      SetWheels(i, left, Uniform() * fastest_rad_s);
    }
  }
  double half_side_m() const { return side_m_ / 2; }

 private:
  double Uniform() { return static_cast<double>(random_() % 2001) / 1000 - 1; }

  std::mt19937 random_{5};
  double side_m_ = 0;
};

class Crowd : public testing::TestWithParam<std::tuple<Fidelity, bool>> {};

TEST_P(Crowd, TwoHundredRobotsStayUprightOnTheFloorAndWithinTheirWalls) {
  const auto [fidelity, small] = GetParam();
  // 0.3 m² each; small ones as close for their size.
  CrowdScene scene(fidelity, small, 200, small ? 0.07 : 0.3);
  ASSERT_NO_THROW(scene.world());
  const double radius_m = small ? 0.085 : 0.18;
  double tilt = 0, sunk = 0, overlap = 0;
  for (int second = 0; second < 20; ++second) {
    scene.DriveAtRandom(10);
    scene.RunFor(1);
    for (int i = 0; i < scene.robot_count(); ++i) {
      const Pose pose = scene.robot(i);
      tilt = std::max(tilt, TiltOf(pose));
      sunk = std::max(sunk, -pose.p.z());
      ASSERT_LT(pose.p.head<2>().cwiseAbs().maxCoeff(), scene.half_side_m()) << "robot" << i + 1;
      for (int k = 0; k < i; ++k) {
        overlap = std::max(overlap, 2 * radius_m - (scene.robot(k).p - pose.p).head<2>().norm());
      }
    }
  }
  EXPECT_LT(tilt, 0.06);
  EXPECT_LT(sunk, 1e-3);
  EXPECT_LT(overlap, 0.06 * radius_m);
  EXPECT_TRUE(scene.world().TakeFrozen().empty());
}

INSTANTIATE_TEST_SUITE_P(Fidelities, Crowd,
                         testing::Combine(testing::Values(Fidelity::kFull, Fidelity::kRolling,
                                                          Fidelity::kPlanar),
                                          testing::Bool()));

}  // namespace
}  // namespace coopdyn

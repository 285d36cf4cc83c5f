// SPDX-License-Identifier: MIT
// The pose by the wheels' encoders, against the true pose.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn::odometry {
namespace {

class OdometryOf : public testing::TestWithParam<Fidelity> {
 protected:
  void Start(const OdometryModel& odometry = {}) {
    auto model = std::make_shared<RobotModel>(*TestRobot());
    model->AddSensor("odometry", odometry);
    scene_.robot_model = model;
    scene_.fidelity = GetParam();
    scene_.AddRobot(1, 2, 0.5);
  }
  /// The robot's pose in its start frame R.
  Pose Moved() {
    const Pose X_WR0{{1, 2, 0}, FromRollPitchYaw(0, 0, 0.5)};
    return X_WR0.Inverse() * scene_.robot(0);
  }

  PhysicsScene scene_;
};
INSTANTIATE_TEST_SUITE_P(Fidelities, OdometryOf,
                         testing::Values(Fidelity::kFull, Fidelity::kRolling, Fidelity::kPlanar));

TEST_P(OdometryOf, ItFollowsTheRobotOnACircle) {
  Start();
  scene_.SetVelocity(0, 0.4, 0.4);
  scene_.RunFor(5);
  const std::vector<double> values = MeasuredBy(scene_);
  EXPECT_NEAR(values[0], Moved().p.x(), 0.02);
  EXPECT_NEAR(values[1], Moved().p.y(), 0.02);
  EXPECT_NEAR(values[2], Heading(Moved().q), 0.02);
  EXPECT_NEAR(values[3], 0.4, 1e-3);
  EXPECT_NEAR(values[4], 0.4, 1e-3);
}

TEST_P(OdometryOf, EncodersCountWholeSteps) {
  constexpr double kResolution_rad = 0.1;
  Start({.resolution_rad = kResolution_rad});
  scene_.SetVelocity(0, 0.3, 0);
  scene_.RunFor(1);
  const std::vector<double> values = MeasuredBy(scene_);
  const double counts = values[5] / kResolution_rad;
  EXPECT_NEAR(counts, std::round(counts), 1e-9);
  EXPECT_NEAR(values[0], Moved().p.x(), 0.075 * kResolution_rad + 0.01);
}

TEST_P(OdometryOf, SlipMakesItDrift) {
  Start({.slip_stddev = 0.03});
  scene_.SetVelocity(0, 0.4, 0);
  scene_.RunFor(10);
  const std::vector<double> values = MeasuredBy(scene_);
  EXPECT_GT(std::abs(values[1] - Moved().p.y()), 1e-3);
  EXPECT_NEAR(values[0], Moved().p.x(), 0.2);
}

TEST_P(OdometryOf, ItGoesOnFromARestoredFrame) {
  Start({.resolution_rad = 0.01});
  scene_.SetVelocity(0, 0.4, 0.3);
  scene_.RunFor(0.5);
  const auto saved = std::make_shared<Frame>();
  saved->scene = scene_.Capture()->scene;
  scene_.world().Fill(*saved);
  scene_.RunFor(0.5);
  const std::vector<double> expected = MeasuredBy(scene_);
  scene_.Restore(*saved);
  scene_.RunFor(0.5);
  EXPECT_EQ(MeasuredBy(scene_), expected);
}

}  // namespace
}  // namespace coopdyn::odometry

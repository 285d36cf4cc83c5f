// SPDX-License-Identifier: MIT
// The minibot drives as an ideal differential drive, in every fidelity, at the default step of 10 ms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/model/drive.h"
#include "server/model/readers.h"
#include "server/physics/world.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

constexpr double kStep_s = 0.01;

/// One minibot on an empty floor, driven by its wheels.
class MinibotDriveTest : public ::testing::TestWithParam<Fidelity> {
 protected:
  MinibotDriveTest() : library_(SearchPath{{SourceDir()}}) {
    Diagnostics diagnostics;
    const auto scenario =
        ReadScenario("[FLOOR]\nsize 50 50\n[ROBOT_1]\ntype minibot\nposition 0 0\nfidelity " +
                         std::string(ToString(GetParam())) + "\n",
                     "test.scenario", library_, false, diagnostics);
    frame_.scene = MakeScene(scenario);
    world_ = PhysicsWorld::Build(frame_.scene, 1, diagnostics);
    EXPECT_EQ(diagnostics.ToString(), "");
  }

  /// Drives with `v_m_s` and `w_rad_s` for `seconds`; returns the final pose.
  Pose Drive(double v_m_s, double w_rad_s, double seconds) {
    const DriveModel& drive = *frame_.scene->robots[0].entry.model->drive();
    const auto wheels = SetpointsFor({(v_m_s - w_rad_s * drive.track_m / 2) / drive.wheel_radius_m,
                                      (v_m_s + w_rad_s * drive.track_m / 2) / drive.wheel_radius_m});
    for (int step = 0; step < std::lround(seconds / kStep_s); ++step) {
      world_->Step(kDefaultStep, 1, wheels);
      world_->Fill(frame_);
      const Pose X_WR = RobotPose(frame_, 0);
      turned_rad_ += WrapAngle(Heading(X_WR.q) - heading_rad_);
      heading_rad_ = Heading(X_WR.q);
      highest_m_ = std::max(highest_m_, std::abs(X_WR.p.z()));
      most_tilt_rad_ = std::max(most_tilt_rad_, std::acos(std::min(1.0, (X_WR.q * Vector3::UnitZ()).z())));
    }
    return RobotPose(frame_, 0);
  }

  RobotLibrary library_;
  Frame frame_;
  std::unique_ptr<PhysicsWorld> world_;
  double turned_rad_ = 0, heading_rad_ = 0, highest_m_ = 0, most_tilt_rad_ = 0;
};

TEST_P(MinibotDriveTest, DrivesStraight) {
  const Pose start = Drive(0.4, 0, 1);
  const Pose end = Drive(0.4, 0, 10);
  EXPECT_NEAR((end.p - start.p).x(), 4, 0.002);
  EXPECT_NEAR((end.p - start.p).y(), 0, 0.001);
  EXPECT_NEAR(turned_rad_, 0, 1e-3);
}

TEST_P(MinibotDriveTest, TurnsOnTheSpot) {
  Drive(0, 2, 1);
  const Pose start = RobotPose(frame_, 0);
  const double before = turned_rad_;
  const Pose end = Drive(0, 2, 10);
  EXPECT_NEAR(turned_rad_ - before, 20, 20 * 0.002);
  EXPECT_LT((end.p - start.p).norm(), 0.002);
}

TEST_P(MinibotDriveTest, DrivesACircle) {
  // Radius 0.5 m, two turns.
  const double w = 0.6, v = 0.3;
  Drive(v, w, 1);
  const Pose start = RobotPose(frame_, 0);
  const double before = turned_rad_;
  const Vector3 centre = start * Vector3(0, 0.5, 0);
  const Pose end = Drive(v, w, 4 * std::numbers::pi / w);
  EXPECT_NEAR((end.p - centre).head<2>().norm(), 0.5, 0.002);
  EXPECT_NEAR(turned_rad_ - before, w * kStep_s * std::round(4 * std::numbers::pi / w / kStep_s), 0.02);
}

TEST_P(MinibotDriveTest, StaysUprightWhenItStartsAndStopsHard) {
  for (int i = 0; i < 5; ++i) {
    Drive(0.5, 0, 0.5);
    Drive(-0.5, 0, 0.5);
    Drive(0, 7, 0.5);
  }
  EXPECT_LT(most_tilt_rad_, 0.05);
  EXPECT_LT(highest_m_, 0.003);
}

INSTANTIATE_TEST_SUITE_P(Fidelities, MinibotDriveTest,
                         ::testing::Values(Fidelity::kFull, Fidelity::kRolling, Fidelity::kPlanar),
                         [](const auto& info) { return ToString(info.param); });

}  // namespace
}  // namespace coopdyn

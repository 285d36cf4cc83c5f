// SPDX-License-Identifier: MIT
// Every fidelity against the ideal kinematics of a differential drive, at several step sizes.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn {
namespace {

const char* NameOf(Fidelity fidelity) {
  return fidelity == Fidelity::kFull ? "full" : fidelity == Fidelity::kRolling ? "rolling" : "planar";
}

/// Allowed deviation of a robot from the ideal at the end, after one second of acceleration.
struct Tolerance {
  double position_m = 0, heading_rad = 0;
};

class Accuracy : public testing::TestWithParam<std::tuple<Fidelity, int>> {
 protected:
  Fidelity fidelity() const { return std::get<0>(GetParam()); }
  int step_ms() const { return std::get<1>(GetParam()); }

  /// Drives for a second, then for `duration_s`, and compares with the exact arc.
  void Drive(double forward_m_s, double turn_rad_s, double duration_s, const Tolerance& tolerance) {
    for (const bool small : {false, true}) {
      PhysicsScene scene;
      scene.step_length = step_ms() * 1'000'000;
      scene.fidelity = fidelity();
      if (small) scene.robot_model = SmallRobot();
      scene.AddRobot(0.3, -0.2, 0.5).SetVelocity(0, forward_m_s, turn_rad_s);
      scene.RunFor(1);
      const Pose start = scene.robot(0);
      scene.RunFor(duration_s);
      const double heading = Heading(start.q), turned = turn_rad_s * duration_s;
      Vector3 ideal = start.p;
      if (turn_rad_s == 0) {
        ideal += forward_m_s * duration_s * Vector3(std::cos(heading), std::sin(heading), 0);
      } else {
        ideal += forward_m_s / turn_rad_s *
                 Vector3(std::sin(heading + turned) - std::sin(heading),
                         std::cos(heading) - std::cos(heading + turned), 0);
      }
      const Pose end = scene.robot(0);
      EXPECT_LT((end.p - ideal).norm(), tolerance.position_m) << (small ? "small" : "large");
      EXPECT_LT(std::abs(WrapAngle(Heading(end.q) - heading - turned)), tolerance.heading_rad)
          << (small ? "small" : "large");
      EXPECT_LT(TiltOf(end), 1e-3);
    }
  }
  /// Fidelity `full` steps hinges and wheel bodies, whose error grows with the square of the step.
  Tolerance Of(double closed_m, double closed_rad, double full_m, double full_rad) const {
    if (fidelity() != Fidelity::kFull) return {closed_m, closed_rad};
    const double grows = step_ms() <= 10 ? 1 : 4;
    return {full_m * grows, full_rad * grows};
  }
};

constexpr double kDegree = 0.017453292519943295;

TEST_P(Accuracy, StraightTenMetres) {
  Drive(0.5, 0, 20, Of(1e-9, 1e-9, 1e-3, 0.01 * kDegree));
}

TEST_P(Accuracy, CircleOfTwoMetresForThirtySeconds) {
  Drive(0.5, 0.25, 30, Of(1e-9, 1e-9, 1e-3, 0.1 * kDegree));
}

TEST_P(Accuracy, SpinsOnTheSpotForThirtySeconds) {
  Drive(0, 2, 30, Of(1e-9, 1e-9, 1e-3, 1 * kDegree));
}

TEST_P(Accuracy, StandsStillForAMinute) {
  PhysicsScene scene;
  scene.step_length = step_ms() * 1'000'000;
  scene.fidelity = fidelity();
  scene.AddRobot(3, -4, 1).RunFor(60);
  EXPECT_LT((scene.robot(0).p - Vector3(3, -4, 0)).norm(), 1e-4);
  EXPECT_NEAR(Heading(scene.robot(0).q), 1, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Fidelities, Accuracy,
                         testing::Combine(testing::Values(Fidelity::kFull, Fidelity::kRolling,
                                                          Fidelity::kPlanar),
                                          testing::Values(1, 10, 20)),
                         [](const auto& info) {
                           return std::string(NameOf(std::get<0>(info.param))) +
                                  std::to_string(std::get<1>(info.param)) + "ms";
                         });

/// A wall's shadow: robots this near to a wall use ODE although they do not touch it.
class AccuracyBesideAWall : public testing::TestWithParam<std::tuple<Fidelity, int>> {};

TEST_P(AccuracyBesideAWall, StraightTenMetresAlongIt) {
  PhysicsScene scene;
  scene.step_length = std::get<1>(GetParam()) * 1'000'000;
  scene.fidelity = std::get<0>(GetParam());
  // Its side is 0.05 mm away: near enough for a collision test in every step.
  scene.AddRobot(0, 0).Add(Box{Vector3(30, 0.1, 0.5)}, {{0, 0.18005 + 0.05, 0.25}, Quaternion::Identity()});
  scene.SetVelocity(0, 0.5, 0);
  scene.RunFor(1);
  const Pose start = scene.robot(0);
  scene.RunFor(20);
  EXPECT_NEAR(scene.robot(0).p.x() - start.p.x(), 10, 1e-3);
  EXPECT_NEAR(scene.robot(0).p.y(), 0, 1e-3);
  EXPECT_NEAR(Heading(scene.robot(0).q), 0, 0.1 * kDegree);
  EXPECT_LT(TiltOf(scene.robot(0)), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Fidelities, AccuracyBesideAWall,
                         testing::Combine(testing::Values(Fidelity::kRolling, Fidelity::kPlanar),
                                          testing::Values(1, 10, 20)));

/// On a box, robots of fidelity rolling always use ODE.
class AccuracyOnABox : public testing::TestWithParam<int> {};

TEST_P(AccuracyOnABox, CircleOfHalfAMetreForThirtySeconds) {
  const double top = 0.2, turn = 1;
  PhysicsScene scene;
  scene.step_length = GetParam() * 1'000'000;
  scene.fidelity = Fidelity::kRolling;
  scene.Add(Box{Vector3(6, 6, top)}, {{0, 0, top / 2}, Quaternion::Identity()});
  scene.AddRobot({{0, 0, top}, Quaternion::Identity()}).SetVelocity(0, 0.5, turn);
  scene.RunFor(1);
  const Pose start = scene.robot(0);
  scene.RunFor(30);
  const double h = Heading(start.q), turned = turn * 30;
  const Vector3 ideal =
      start.p +
      0.5 / turn * Vector3(std::sin(h + turned) - std::sin(h), std::cos(h) - std::cos(h + turned), 0);
  EXPECT_LT((scene.robot(0).p - ideal).norm(), 2e-3);
  EXPECT_LT(std::abs(WrapAngle(Heading(scene.robot(0).q) - h - turned)), 0.1 * kDegree);
}

INSTANTIATE_TEST_SUITE_P(Steps, AccuracyOnABox, testing::Values(1, 10, 20));

}  // namespace
}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Drives of four wheels against their formulas: Mecanum, by friction only along the rollers' axes, and skid
// steering, by the balance of all friction.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>

#include "server/model/readers.h"
#include "tests/server/physics/physics_scene.h"

namespace coopdyn::mecanum {
namespace {

constexpr double kRadius_m = 0.1, kHalfBase_m = 0.2, kHalfTrack_m = 0.25;

/// A wheel whose rollers at the floor lie along 1 `y` 0 of the chassis; 0: no rollers.
std::string Wheel(const std::string& name, double x_m, double y_m, int y) {
  const std::string rollers =
      "<mu2>0</mu2><fdir1 gz:expressed_in='chassis'>1 " + std::to_string(y) + " 0</fdir1>";
  return "<link name='" + name + "'><pose>" + std::to_string(x_m) + " " + std::to_string(y_m) + " " +
         std::to_string(kRadius_m) +
         " 0 0 0</pose><inertial><mass>0.5</mass><inertia><ixx>0.002</ixx><iyy>0.002</iyy><izz>0.002</izz>"
         "</inertia></inertial><collision name='c'><geometry><sphere><radius>" +
         std::to_string(kRadius_m) + "</radius></sphere></geometry><surface><friction><ode><mu>1</mu>" +
         (y == 0 ? "" : rollers) + "</ode></friction></surface></collision></link>\n<joint name='" + name +
         "_joint' type='revolute'><parent>chassis</parent><child>" + name +
         "</child><axis><xyz>0 1 "
         "0</xyz><limit><effort>20</effort><velocity>50</velocity></limit></axis></joint>\n";
}

std::shared_ptr<const RobotModel> Rover(bool has_rollers) {
  const int y = has_rollers ? 1 : 0;
  const std::string text =
      "<sdf version='1.9' xmlns:gz='http://gazebosim.org/schema'><model name='rover'>\n"
      "<link name='chassis'><pose>0 0 0.12 0 0 "
      "0</pose><inertial><mass>10</mass><inertia><ixx>0.2</ixx><iyy>0.2"
      "</iyy><izz>0.3</izz></inertia></inertial><collision name='c'><geometry><box><size>0.5 0.3 0.1</size>"
      "</box></geometry></collision></link>\n" +
      Wheel("fl", kHalfBase_m, kHalfTrack_m, -y) + Wheel("fr", kHalfBase_m, -kHalfTrack_m, y) +
      Wheel("bl", -kHalfBase_m, kHalfTrack_m, y) + Wheel("br", -kHalfBase_m, -kHalfTrack_m, -y) +
      "<plugin filename='gz-sim-mecanum-drive-system' name='gz::sim::systems::MecanumDrive'>"
      "<front_left_joint>fl_joint</front_left_joint><front_right_joint>fr_joint</front_right_joint>"
      "<back_left_joint>bl_joint</back_left_joint><back_right_joint>br_joint</back_right_joint>"
      "<wheel_separation>0.5</wheel_separation><wheelbase>0.4</wheelbase><wheel_radius>0.1</wheel_radius>"
      "</plugin></model></sdf>";
  Diagnostics diagnostics;
  auto robot = ReadRobotModelText(text, "rover.sdf", "rover", diagnostics);
  EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.ToString();
  return robot;
}

/// The formula of docs/models.md.
std::array<double, 4> WheelSpeeds(double vx_m_s, double vy_m_s, double wz_rad_s) {
  const double turn_m_s = (kHalfBase_m + kHalfTrack_m) * wz_rad_s;
  return {(vx_m_s - vy_m_s - turn_m_s) / kRadius_m, (vx_m_s + vy_m_s + turn_m_s) / kRadius_m,
          (vx_m_s + vy_m_s - turn_m_s) / kRadius_m, (vx_m_s - vy_m_s + turn_m_s) / kRadius_m};
}

class MecanumTest : public ::testing::TestWithParam<int> {
 protected:
  void Start(double heading_rad, bool has_rollers = true) {
    scene_.step_length = GetParam() * 1'000'000;
    scene_.robot_model = Rover(has_rollers);
    ASSERT_NE(scene_.robot_model, nullptr);
    ASSERT_EQ(scene_.robot_model->actuators.size(), 1u);
    scene_.AddRobot(0, 0, heading_rad);
    scene_.Build();
    ASSERT_EQ(scene_.diagnostics().ToString(), "");
  }
  /// Sets the wheels for this velocity, and waits until the rover has reached it.
  void Drive(double vx_m_s, double vy_m_s, double wz_rad_s) {
    scene_.setpoints.clear();
    for (const double speed : WheelSpeeds(vx_m_s, vy_m_s, wz_rad_s))
      scene_.setpoints.push_back({speed, ControlMode::kVelocity});
    scene_.RunFor(1);
  }
  BodyState Body() { return scene_.Capture()->bodies.front(); }

  PhysicsScene scene_;
};

TEST_P(MecanumTest, ItGoesAsItsWheelsSay) {
  constexpr double kV_m_s = 0.4, kW_rad_s = 0.8;
  for (const auto& [vx, vy, wz] : {std::array{kV_m_s, 0.0, 0.0},
                                   {0.0, kV_m_s, 0.0},
                                   {0.0, 0.0, kW_rad_s},
                                   {-kV_m_s, kV_m_s, 0.0},
                                   {kV_m_s / 2, -kV_m_s / 2, kW_rad_s / 2}}) {
    scene_ = PhysicsScene();
    Start(0.5);
    Drive(vx, vy, wz);
    const Vector3 v_B = scene_.robot(0).q.conjugate() * Body().v_WB;
    EXPECT_NEAR(v_B.x(), vx, 0.01 * kV_m_s) << vx << " " << vy << " " << wz;
    EXPECT_NEAR(v_B.y(), vy, 0.01 * kV_m_s) << vx << " " << vy << " " << wz;
    EXPECT_NEAR(Body().w_WB.z(), wz, 0.01 * kW_rad_s) << vx << " " << vy << " " << wz;
  }
}

TEST_P(MecanumTest, ItsWayIsThatOfItsVelocity) {
  Start(0);
  Drive(0, 0.3, 0);
  const Vector3 before = scene_.robot(0).p;
  scene_.RunFor(3);
  const Vector3 way = scene_.robot(0).p - before;
  EXPECT_NEAR(way.y(), 0.9, 0.005);
  EXPECT_NEAR(way.x(), 0, 0.005);
  EXPECT_NEAR(TiltOf(scene_.robot(0)), 0, 0.01);
}

// Each wheel's friction opposes its slip: (W - W_wheels) b along the wheel, W a across. The moments about the
// vertical balance if W_wheels b² = W (a² + b²).
TEST_P(MecanumTest, WithoutRollersItTurnsAsFarAsFrictionLets) {
  constexpr double kShare =
      kHalfTrack_m * kHalfTrack_m / (kHalfBase_m * kHalfBase_m + kHalfTrack_m * kHalfTrack_m);
  for (const double turn_rad_s : {0.02, 0.2, 1.0, -2.0}) {
    scene_ = PhysicsScene();
    Start(0.5, false);
    const double speed_rad_s = turn_rad_s * kHalfTrack_m / kRadius_m;
    for (const double sign : {-1.0, 1.0, -1.0, 1.0})
      scene_.setpoints.push_back({sign * speed_rad_s, ControlMode::kVelocity});
    scene_.RunFor(2);
    EXPECT_NEAR(Body().w_WB.z() / turn_rad_s, kShare, 0.02) << turn_rad_s;
    EXPECT_NEAR(Body().v_WB.head<2>().norm(), 0, 0.01 * std::abs(turn_rad_s)) << turn_rad_s;
  }
}

INSTANTIATE_TEST_SUITE_P(Steps, MecanumTest, ::testing::Values(1, 5, 10));

}  // namespace
}  // namespace coopdyn::mecanum

// SPDX-License-Identifier: MIT
// Motor models of Gazebo against their laws: thrust = k ω², and the reaction of each rotor.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "server/model/readers.h"
#include "tests/server/physics/physics_scene.h"

namespace coopdyn::rotors {
namespace {

constexpr double kMass_kg = 1.6, kRotor_kg = 0.01, kArm_m = 0.2, kInertia_kg_m2 = 0.03, kHeight_m = 1;
constexpr double kThrust_n_s2 = 8.54858e-6, kMoment_m = 0.016, kFastest_rad_s = 1000;
constexpr double kWeight_n = (kMass_kg + 4 * kRotor_kg) * kG;

/// A rotor at x, y, and its plug-in.
std::string Rotor(const std::string& name, double x_m, double y_m, const std::string& turning) {
  return "<link name='" + name + "'><pose>" + std::to_string(x_m) + " " + std::to_string(y_m) + " " +
         std::to_string(kHeight_m) + " 0 0 0</pose><inertial><mass>" + std::to_string(kRotor_kg) +
         "</mass><inertia><ixx>1e-5</ixx><iyy>1e-5</iyy><izz>1e-5</izz></inertia></inertial></link>\n"
         "<joint name='" +
         name + "_joint' type='revolute'><parent>base</parent><child>" + name +
         "</child><axis><xyz>0 0 1</xyz></axis></joint>\n"
         "<plugin filename='gz-sim-multicopter-motor-model-system' "
         "name='gz::sim::systems::MulticopterMotorModel'><jointName>" +
         name + "_joint</jointName><linkName>" + name + "</linkName><turningDirection>" + turning +
         "</turningDirection><maxRotVelocity>" + std::to_string(kFastest_rad_s) +
         "</maxRotVelocity><motorConstant>8.54858e-06</motorConstant>"
         "<momentConstant>0.016</momentConstant></plugin>\n";
}

/// Two rotors in front and behind, which turn one way, two at the sides, which turn the other way.
std::shared_ptr<const RobotModel> Quadrotor() {
  const std::string text =
      "<sdf version='1.9'><model name='quad'>\n<link name='base'><pose>0 0 1 0 0 0</pose><inertial><mass>" +
      std::to_string(kMass_kg) +
      "</mass><inertia><ixx>0.03</ixx><iyy>0.03</iyy><izz>0.03</izz></inertia>"
      "</inertial><collision name='c'><geometry><box><size>0.2 0.2 0.1</size></box></geometry></collision>"
      "</link>\n" +
      Rotor("r0", kArm_m, 0, "ccw") + Rotor("r1", -kArm_m, 0, "ccw") + Rotor("r2", 0, kArm_m, "cw") +
      Rotor("r3", 0, -kArm_m, "cw") + "</model></sdf>";
  Diagnostics diagnostics;
  auto robot = ReadRobotModelText(text, "quad.sdf", "quad", diagnostics);
  EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.ToString();
  return robot;
}

class RotorTest : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    scene_.step_length = GetParam() * 1'000'000;
    scene_.robot_model = Quadrotor();
    ASSERT_NE(scene_.robot_model, nullptr);
    ASSERT_EQ(scene_.robot_model->actuators.size(), 1u);
    scene_.AddRobot(0, 0);
    scene_.Build();
    ASSERT_EQ(scene_.diagnostics().ToString(), "");
  }
  /// Thrusts for the speeds of the rotors.
  void Turn(double rad_s_0, double rad_s_1, double rad_s_2, double rad_s_3) {
    scene_.setpoints.clear();
    for (const double rad_s : {rad_s_0, rad_s_1, rad_s_2, rad_s_3})
      scene_.setpoints.push_back({kThrust_n_s2 * rad_s * rad_s, ControlMode::kEffort});
  }
  void TurnAll(double rad_s) { Turn(rad_s, rad_s, rad_s, rad_s); }
  BodyState Body() { return scene_.Capture()->bodies.front(); }

  const double hover_rad_s_ = std::sqrt(kWeight_n / 4 / kThrust_n_s2);
  PhysicsScene scene_;
};

TEST_P(RotorTest, ItHoversAtTheSpeedWhoseThrustIsItsWeight) {
  const double start_m = Body().p_WB.z();
  TurnAll(hover_rad_s_);
  scene_.RunFor(3);
  EXPECT_NEAR(Body().p_WB.z(), start_m, 1e-5);
  EXPECT_NEAR(Body().w_WB.norm(), 0, 1e-6);
}

TEST_P(RotorTest, ItClimbsByTheThrustAboveItsWeight) {
  TurnAll(1.1 * hover_rad_s_);
  scene_.RunFor(1);
  EXPECT_NEAR(Body().v_WB.z(), 0.21 * kG, 0.001 * kG);
}

TEST_P(RotorTest, ItYawsAgainstTheRotorsThatTurnFaster) {
  // The faster ones turn to the left: their reaction turns the copter to the right. The total thrust equals
  // its weight.
  const double more = std::sqrt(1.2) * hover_rad_s_, less = std::sqrt(0.8) * hover_rad_s_;
  Turn(more, more, less, less);
  scene_.RunFor(1);
  const double inertia_kg_m2 = kInertia_kg_m2 + 4 * kRotor_kg * kArm_m * kArm_m;
  const double wanted_rad_s = -kMoment_m * 0.2 * kWeight_n / inertia_kg_m2;
  EXPECT_NEAR(Body().w_WB.z(), wanted_rad_s, 0.002 * std::abs(wanted_rad_s));
  EXPECT_NEAR(Body().v_WB.z(), 0, 1e-5);
}

TEST_P(RotorTest, ARotorGivesNoMoreThanItsGreatestThrust) {
  TurnAll(3 * kFastest_rad_s);
  scene_.RunFor(0.5);
  const double most_n = 4 * kThrust_n_s2 * kFastest_rad_s * kFastest_rad_s;
  const double wanted_m_s = (most_n - kWeight_n) / (kWeight_n / kG) * 0.5;
  EXPECT_NEAR(Body().v_WB.z(), wanted_m_s, 0.001 * wanted_m_s);
}

INSTANTIATE_TEST_SUITE_P(Steps, RotorTest, ::testing::Values(1, 5, 10));

}  // namespace
}  // namespace coopdyn::rotors

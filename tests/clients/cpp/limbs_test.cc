// SPDX-License-Identifier: MIT
// Muscles, thrusters, drive trains and the channel of a robot, in lockstep and in real time.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "clients/cpp/coopdyn_client.h"
#include "tests/clients/cpp/error_of.h"
#include "tests/clients/cpp/made_robot.h"
#include "tests/clients/cpp/server_process.h"

namespace coopdyn::client {
namespace {

using Numbers = std::vector<double>;

class LimbsTest : public testing::Test {
 protected:
  const MadeRobot made_ = MadeRobot("limbs");
  const ServerProcess daemon_ = ServerProcess::Command({"serve", made_.scenario()});
  Simulation sim_ = connect(daemon_.server());
  Robot robot_ = sim_.robot("robot1");
};

TEST_F(LimbsTest, AnActivationGoesWithTheNextStep) {
  Muscles muscles = robot_.muscles();
  muscles.set_activations({0.5, 0.2});
  EXPECT_EQ(muscles.get().activation, (Numbers{0, 0}));
  sim_.step();
  EXPECT_EQ(muscles.get().activation, (Numbers{0.5, 0.2}));
}

TEST_F(LimbsTest, AMuscleThatIsNamedPullsAndTheOtherKeepsItsActivation) {
  Muscles muscles = robot_.muscles();
  muscles.set_activations({0.1});
  sim_.step();
  muscles.set_activations({0.8}, "biceps");
  sim_.step(20);
  const MuscleReading seen = muscles.get();
  EXPECT_EQ(seen.activation, (Numbers{0.8, 0.1}));
  EXPECT_GT(seen.force[0], seen.force[1]);
  EXPECT_LT(seen.length[0], 0.45);
  EXPECT_EQ(muscles.get(2).length, Numbers{seen.length[1]});
  EXPECT_LT(seen.velocity[0], 0);
  EXPECT_LT(seen.length_factor[0], 1);
  EXPECT_LT(seen.velocity_factor[0], 1);
}

TEST_F(LimbsTest, MusclesHaveNamesAndLimits) {
  Muscles muscles = robot_.muscles();
  EXPECT_EQ(muscles.names(), (std::vector<std::string>{"biceps", "triceps"}));
  EXPECT_EQ(muscles.get_limits().max_force, (Numbers{30, 30}));
  EXPECT_EQ(muscles.get_limits().optimal_length, (Numbers{0.5, 0.5}));
  EXPECT_EQ(muscles.get_limits().max_velocity, (Numbers{2, 2}));
}

TEST_F(LimbsTest, ThrustsGoWithTheNextStep) {
  Thrusters thrusters = robot_.thrusters();
  thrusters.set_thrusts({2, 0.1});
  sim_.step();
  thrusters.set_thrusts({-1}, "jet");
  sim_.step();
  EXPECT_EQ(thrusters.get().thrust, (Numbers{-1, 0.1}));
  EXPECT_EQ(thrusters.get("spin").velocity.size(), 1u);
}

TEST_F(LimbsTest, ThrustersHaveNamesAndLimits) {
  Thrusters thrusters = robot_.thrusters();
  EXPECT_EQ(thrusters.names(), (std::vector<std::string>{"jet", "spin"}));
  EXPECT_EQ(thrusters.get_limits().max_thrust, (Numbers{5, 0.2}));
}

TEST_F(LimbsTest, ADutyPutsAJointIntoTheModePwm) {
  Joints joints = robot_.joints();
  joints.set_pwm({0.5});
  sim_.step(50);
  EXPECT_EQ(joints.get_modes(), std::vector<std::string>{"pwm"});
  EXPECT_NEAR(joints.get().velocity[0], 2.5, 1e-3);  // half of 50 rad/s, over a gear of 10
}

TEST_F(LimbsTest, ADriveTrainTellsRotorCurrentAndEnergy) {
  Joints joints = robot_.joints();
  joints.set_pwm({0.5}, "knee");
  sim_.step();
  const DriveTrains train = joints.get_drive_trains();
  EXPECT_NEAR(train.rotor_position[0], joints.get().position[0], 1e-6);
  EXPECT_GT(train.rotor_velocity[0], 0);
  EXPECT_GT(train.current[0], 0);
  EXPECT_GT(train.energy[0], 0);
}

TEST_F(LimbsTest, TheModePwmBrakesUntilThereIsADuty) {
  Joints joints = robot_.joints();
  joints.set_modes({"pwm"});
  sim_.step();
  EXPECT_EQ(joints.get_modes(), std::vector<std::string>{"pwm"});
  EXPECT_EQ(joints.get_references(), Numbers{0});
}

TEST_F(LimbsTest, AllActuatorsAreDrivenInRealTimeToo) {
  sim_.set_mode("realtime");
  Muscles muscles = robot_.muscles();
  Thrusters thrusters = robot_.thrusters();
  muscles.set_activations({0.5});
  thrusters.set_thrusts({0.1}, "spin");
  sim_.step(2);
  EXPECT_EQ(muscles.get().activation, (Numbers{0.5, 0.5}));
  EXPECT_EQ(thrusters.get("spin").thrust, Numbers{0.1});
}

TEST_F(LimbsTest, ASimThatIsClosedLetsMusclesGo) {
  robot_.muscles().set_activations({0.5});
  sim_.step();
  sim_.close();
  Simulation again = connect(daemon_.server());
  Robot robot = again.robot("robot1");
  again.step();
  EXPECT_EQ(robot.muscles().get().activation, (Numbers{0, 0}));
}

TEST_F(LimbsTest, ARobotWithoutThemSaysWhatItHas) {
  Robot robot = sim_.robot("robot2");
  EXPECT_TRUE(Says(ErrorOf([&] { robot.muscles(); }), "5 robot2 has no muscles; its actuators: motors"));
  EXPECT_TRUE(Says(ErrorOf([&] { robot.thrusters(); }), "5 robot2 has no thrusters; its actuators: motors"));
  EXPECT_TRUE(Says(ErrorOf([&] { robot.channel(); }), "5 robot2 has no channel; its actuators: motors"));
}

TEST_F(LimbsTest, WrongNamesAndCountsSayWhatToWrite) {
  Muscles muscles = robot_.muscles();
  EXPECT_TRUE(Says(ErrorOf([&] { muscles.set_activations({1}, "calf"); }), "no muscle 'calf'"));
  EXPECT_TRUE(Says(ErrorOf([&] { muscles.get(3); }), "muscles 1 to 2"));
  EXPECT_TRUE(Says(ErrorOf([&] { muscles.set_activations({1, 2, 3}); }), "each of the 2 muscles"));
  EXPECT_EQ(ErrorOf([&] { muscles.set_activations({std::nan("")}); }).code(), 4);
}

TEST_F(LimbsTest, AChannelHasMotorsAndValuesWithNamesAndRanges) {
  Channel channel = robot_.channel();
  ASSERT_EQ(channel.motors().size(), 2u);
  ASSERT_EQ(channel.values().size(), 3u);
  const Mapped& knee = channel.motors()[0];
  EXPECT_EQ(knee.name, "knee_motor");
  EXPECT_EQ((Numbers{knee.internal_min, knee.internal_max, knee.external_min, knee.external_max}),
            (Numbers{-4, 4, -1, 1}));
  EXPECT_EQ(channel.values()[1].external_max, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(channel.values()[1].auxiliary);
  EXPECT_EQ(channel.steps(), 2);
}

TEST_F(LimbsTest, WhatAChannelSetsGoesWithTheNextStepAndStays) {
  Channel channel = robot_.channel();
  channel.set({0.5, 0.3});
  sim_.step(40);
  EXPECT_EQ(sim_.steps(), 40);
  EXPECT_NEAR(channel.get("knee_speed")[0], 0.5, 1e-3);
  EXPECT_EQ(robot_.muscles().get("biceps").activation, Numbers{0.3});
}

TEST_F(LimbsTest, AMotorThatIsNamedIsSetAndTheOthersStay) {
  Channel channel = robot_.channel();
  channel.set({0.5});
  channel.set({0.2}, "knee_motor");
  sim_.step(40);
  EXPECT_NEAR(channel.get(1)[0], 0.2, 1e-3);
  EXPECT_EQ(robot_.muscles().get("biceps").activation, Numbers{0.5});
}

TEST_F(LimbsTest, ValuesAreReadByNameAndNumber) {
  Channel channel = robot_.channel();
  sim_.step();
  const Numbers values = channel.get();
  EXPECT_EQ(channel.get("place"), (Numbers{values[1], values[2]}));
  EXPECT_EQ(channel.get({3, 1}), (Numbers{values[2], values[0]}));
  EXPECT_FALSE(channel.aborted());
}

TEST_F(LimbsTest, ARobotThatItsChannelDrivesTakesNothingElse) {
  Muscles muscles = robot_.muscles();
  robot_.channel();
  EXPECT_TRUE(Says(ErrorOf([&] { muscles.set_activations({1}); }), "driven through its channel"));
  sim_.step();
  EXPECT_EQ(robot_.sense().step, 1);
}

TEST_F(LimbsTest, TheFirstExchangeSetsAllMotors) {
  Channel channel = robot_.channel();
  EXPECT_TRUE(Says(ErrorOf([&] { channel.set({0.2}, "pull"); }), "all 2 motors first"));
}

}  // namespace
}  // namespace coopdyn::client

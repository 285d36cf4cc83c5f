// SPDX-License-Identifier: MIT
// <coopdyn:channel>: its content and its errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/model/sensor_rig.h"

namespace coopdyn::channel_reader {
namespace {

using sensor_rig::ModuleOf;
using sensor_rig::ReadRig;
using sensor_rig::WrongElement;
using ::testing::HasSubstr;
using Measured = ChannelModel::Quantity;

std::string ChannelOf(const std::string& inside, const std::string& attributes = "") {
  return "<coopdyn:channel" + attributes + ">\n" + inside + "\n</coopdyn:channel>";
}

std::string WrongIn(const std::string& inside, const std::string& attributes = "") {
  return WrongElement("channel", ChannelOf(inside, attributes));
}

ChannelModel ReadChannel(const std::string& inside, const std::string& attributes = "",
                         const std::string& more = "") {
  const auto [robot, messages] = ReadRig(more + ChannelOf(inside, attributes) + "\n" + ModuleOf("channel"));
  EXPECT_EQ(messages, "");
  if (robot == nullptr || robot->Find<ChannelModel>() == nullptr) return {};
  return *robot->Find<ChannelModel>();
}

TEST(ChannelReaderTest, AMotorHasAJointAModeAndItsMapping) {
  const ChannelModel channel = ReadChannel(
      "<coopdyn:motor name=\"bend\" joint=\"knuckle\" mode=\"direct\" internal=\"-0.5 0.5\" external=\"1 "
      "-1\" "
      "noise=\"gaussian\" noise_sigma=\"0.1\" noise_mean=\"0.2\"/>",
      " steps=\"10\"");
  EXPECT_EQ(channel.steps, 10);
  ASSERT_EQ(channel.motors.size(), 1u);
  const ChannelModel::Motor& motor = channel.motors[0];
  EXPECT_EQ(motor.name, "bend");
  EXPECT_EQ(motor.mode, ControlMode::kDirect);
  EXPECT_EQ(motor.channel, 1u);  // the second joint of the board
  EXPECT_EQ(motor.map.internal_min, -0.5);
  EXPECT_EQ(motor.map.external_max, -1);
  EXPECT_EQ(motor.noise.kind, MappedNoise::Kind::kGaussian);
  EXPECT_EQ(motor.noise.mean, 0.2);
}

TEST(ChannelReaderTest, ItMayHaveAPort) {
  const std::string value = "<coopdyn:value name=\"sun\" of=\"ambient_light\"/>";
  EXPECT_EQ(ReadChannel(value).port, 0);
  EXPECT_EQ(ReadChannel(value, " port=\"9500\"").port, 9500);
  EXPECT_THAT(WrongIn(value, " port=\"65536\""), HasSubstr("port"));
}

TEST(ChannelReaderTest, AValueIsOfAModuleAJointAPlaceOrTheWorld) {
  const ChannelModel channel = ReadChannel(
      "<coopdyn:value name=\"up\" module=\"imu\" index=\"10\"/>"
      "<coopdyn:value name=\"turn\" joint=\"knuckle\" of=\"velocity\"/>"
      "<coopdyn:value name=\"tip\" link=\"hand\" pose=\"0 0 0.1 0 0 0\" of=\"vz\" frame=\"body\"/>"
      "<coopdyn:value name=\"sun\" of=\"ambient_light\" auxiliary=\"true\"/>",
      "", ModuleOf("imu"));
  ASSERT_EQ(channel.values.size(), 4u);
  EXPECT_EQ(channel.values[0].quantity, Measured::kReading);
  EXPECT_EQ(channel.values[0].index, 9u);
  EXPECT_EQ(channel.values[1].quantity, Measured::kVelocity);
  EXPECT_EQ(channel.values[2].quantity, Measured::kVz);
  EXPECT_TRUE(channel.values[2].in_body);
  EXPECT_EQ(channel.values[3].quantity, Measured::kAmbientLight);
  EXPECT_TRUE(channel.values[3].auxiliary);
}

TEST(ChannelReaderTest, WhatItNamesIsThere) {
  EXPECT_THAT(WrongIn("<coopdyn:motor name=\"m\" joint=\"knukle\"/>"), HasSubstr("did you mean 'knuckle'"));
  EXPECT_THAT(WrongIn("<coopdyn:value name=\"v\" joint=\"elbow\"/>"), HasSubstr("no joint 'elbow'"));
  EXPECT_THAT(WrongIn("<coopdyn:value name=\"v\" module=\"sonar\"/>"), HasSubstr("module 'sonar'"));
  EXPECT_THAT(WrongIn("<coopdyn:value name=\"v\" link=\"foot\" of=\"x\"/>"), HasSubstr("no link 'foot'"));
}

TEST(ChannelReaderTest, AValueHasAFilter) {
  const ChannelModel channel = ReadChannel(
      "<coopdyn:value name=\"a\" of=\"ambient_light\" filter=\"median\" filter_steps=\"5\"/>"
      "<coopdyn:value name=\"b\" of=\"ambient_light\" filter=\"low_pass\" filter_time_s=\"0.2\"/>");
  ASSERT_EQ(channel.values.size(), 2u);
  EXPECT_EQ(channel.values[0].filter.kind, ValueFilter::Kind::kMedian);
  EXPECT_EQ(channel.values[0].filter.steps, 5);
  EXPECT_EQ(channel.values[1].filter.time_s, 0.2);
  EXPECT_EQ(channel.values[1].first_cell, 6u);
  EXPECT_EQ(channel.cells(), 8u);
}

TEST(ChannelReaderTest, AFilterSaysHowLong) {
  const auto wrong = [](const std::string& filter) {
    return WrongIn("<coopdyn:value name=\"a\" of=\"ambient_light\" " + filter + "/>");
  };
  EXPECT_THAT(wrong("filter=\"mean\""), HasSubstr("the attribute 'filter_steps' is missing"));
  EXPECT_THAT(wrong("filter=\"low_pass\""), HasSubstr("the attribute 'filter_time_s' is missing"));
  EXPECT_THAT(wrong("filter=\"lowpass\""), HasSubstr("did you mean 'low_pass'"));
  EXPECT_THAT(wrong("filter_steps=\"3\""), HasSubstr("filter=\"low_pass\" has 'filter_time_s'"));
}

TEST(ChannelReaderTest, AMotorMayLimitTheEffortOfAnother) {
  const auto [robot, messages] =
      ReadRig(ChannelOf("<coopdyn:motor name=\"force\" joint=\"knuckle\" mode=\"limit\"/>") + "\n" +
              ModuleOf("channel"));
  EXPECT_EQ(messages, "");
  ASSERT_NE(robot, nullptr);
  const JointModel& limiter = robot->joints.back();
  EXPECT_EQ(limiter.kind, JointModel::Kind::kLimiter);
  const JointModel& knuckle = robot->joints[static_cast<std::size_t>(limiter.limits)];
  EXPECT_EQ(knuckle.name, "knuckle");
  EXPECT_EQ(limiter.upper, knuckle.max_effort);
  const ChannelModel::Motor& motor = robot->Find<ChannelModel>()->motors[0];
  EXPECT_EQ(motor.channel, robot->FirstChannel(robot->actuators.back()));
  EXPECT_EQ(Limit(limiter, {99, motor.mode}).reference, knuckle.max_effort);
}

TEST(ChannelReaderTest, AMotorHasAnEnergy) {
  const ChannelModel channel = ReadChannel("<coopdyn:value name=\"work\" joint=\"knuckle\" of=\"energy\"/>");
  ASSERT_EQ(channel.values.size(), 1u);
  EXPECT_TRUE(channel.values[0].sums_work);
  EXPECT_EQ(channel.values[0].channel, 1u);
}

TEST(ChannelReaderTest, AnIndexLiesWithinItsReading) {
  EXPECT_THAT(WrongElement("imu\"/><coopdyn:module type=\"channel",
                           ChannelOf("<coopdyn:value name=\"v\" module=\"imu\" index=\"11\"/>")),
              HasSubstr("has 10 values"));
}

TEST(ChannelReaderTest, RangesHaveTwoEndsThatDiffer) {
  EXPECT_THAT(WrongIn("<coopdyn:value name=\"v\" joint=\"knuckle\" internal=\"1 1\"/>"),
              HasSubstr("'internal'"));
  EXPECT_THAT(WrongIn("<coopdyn:value name=\"v\" joint=\"knuckle\" external=\"0 1\"/>"),
              HasSubstr("needs 'internal'"));
  EXPECT_THAT(WrongIn("<coopdyn:value name=\"v\" joint=\"knuckle\" internal=\"0 1\" external=\"2 2\"/>"),
              HasSubstr("must differ"));
  EXPECT_THAT(WrongIn("<coopdyn:value name=\"v\" joint=\"knuckle\" internal=\"0 nan\"/>"),
              HasSubstr("finite"));
}

TEST(ChannelReaderTest, WordsAreThoseOfTheTable) {
  EXPECT_THAT(WrongIn("<coopdyn:motor name=\"m\" joint=\"knuckle\" mode=\"speed\"/>"),
              HasSubstr("position, direct, velocity, effort, pwm, ignored"));
  EXPECT_THAT(WrongIn("<coopdyn:value name=\"v\" joint=\"knuckle\" of=\"x\"/>"), HasSubstr("'of' a joint"));
  EXPECT_THAT(WrongIn("<coopdyn:value name=\"v\"/>"), HasSubstr("says nothing to measure"));
  EXPECT_THAT(WrongIn("<coopdyn:value name=\"v w\" of=\"ambient_light\"/>"), HasSubstr("no blanks"));
  EXPECT_THAT(WrongIn("<coopdyn:sensor name=\"v\"/>"), HasSubstr("unknown element"));
}

TEST(ChannelReaderTest, AbortNamesContactSensors) {
  EXPECT_THAT(WrongElement("imu\"/><coopdyn:module type=\"channel",
                           ChannelOf("<coopdyn:value name=\"v\" of=\"ambient_light\"/>", " abort=\"imu\"")),
              HasSubstr("names contact modules"));
}

TEST(ValueMapTest, AValueIsMappedAndCutBothWays) {
  const ValueMap map{-2, 2, 1, -1};
  EXPECT_EQ(map.ToExternal(-2), 1);
  EXPECT_EQ(map.ToExternal(1), -0.5);
  EXPECT_EQ(map.ToExternal(7), -1);
  EXPECT_EQ(map.ToInternal(0.5), -1);
  EXPECT_EQ(map.ToInternal(-7), 2);
}

TEST(ValueMapTest, WithoutRangesAValueStaysAsItIs) {
  EXPECT_EQ(ValueMap().ToExternal(3.25), 3.25);
  EXPECT_EQ(ValueMap().ToInternal(-3.25), -3.25);
  const ValueMap cut{0, 1, -ValueMap::kInfinity, ValueMap::kInfinity};
  EXPECT_EQ(cut.ToExternal(2), 1);
}

}  // namespace
}  // namespace coopdyn::channel_reader

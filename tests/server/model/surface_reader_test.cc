// SPDX-License-Identifier: MIT
// <surface> of SDF: anisotropic, rolling and spinning friction.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/server/model/foreign_rig.h"

namespace coopdyn {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

/// A model of one link with this in <friction>; its collision is turned by 90° about z.
ForeignAnswer ReadFriction(const std::string& inside) {
  return ReadSdf(
      "<link name=\"l\"><pose>0 0 0.1 0 0 0</pose>"
      "<inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia>"
      "</inertial>\n<collision name=\"c\"><pose>0 0 0 0 0 "
      "1.5707963267948966</pose><geometry><sphere><radius>0.1"
      "</radius></sphere></geometry><surface><friction>\n" +
      inside + "</friction></surface></collision></link>\n");
}

TEST(SurfaceReaderTest, FrictionMayHaveAGrain) {
  const auto [robot, messages] = ReadFriction("<ode><mu>0.2</mu><mu2>0.6</mu2><fdir1>2 0 0</fdir1></ode>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(messages, "");
  const LinkShape& shape = robot->links[0].collisions.at(0);
  EXPECT_EQ(shape.friction, 0.2);
  EXPECT_EQ(shape.friction_across, 0.6);
  EXPECT_LT((shape.friction_along_G - Vector3::UnitX()).norm(), 1e-12);  // in the collision's own frame
}

TEST(SurfaceReaderTest, AnotherLinkMayCarryTheGrain) {
  for (const char* key : {"gz:expressed_in", "ignition:expressed_in"}) {
    const auto [robot, messages] = ReadFriction("<ode><mu>0.2</mu><mu2>0.6</mu2><fdir1 " + std::string(key) +
                                                "=\"l\">2 0 0</fdir1></ode>");
    ASSERT_NE(robot, nullptr) << messages;
    EXPECT_EQ(messages, "");
    const LinkShape& shape = robot->links[0].collisions.at(0);
    ASSERT_EQ(shape.friction_frame, 0);
    EXPECT_EQ(robot->frames.at(0).name, "l");
    EXPECT_EQ(shape.friction_along_G, Vector3::UnitX());  // in the link's frame
  }
  const auto wrong =
      ReadFriction("<ode><mu>0.2</mu><mu2>0.6</mu2>\n<fdir1 gz:expressed_in=\"k\">1 0 0</fdir1></ode>");
  ASSERT_NE(wrong.robot, nullptr) << wrong.messages;
  EXPECT_EQ(wrong.robot->links[0].collisions.at(0).friction_frame, -1);
  EXPECT_THAT(wrong.messages,
              HasSubstr("model.sdf:5: warning: gz:expressed_in of <fdir1> names no link, 'k'"));
}

TEST(SurfaceReaderTest, AGrainNeedsADirection) {
  const auto [robot, messages] = ReadFriction("<ode><mu>0.2</mu><mu2>0.6</mu2></ode>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_TRUE(robot->links[0].collisions.at(0).friction_along_G.isZero());
  EXPECT_THAT(messages,
              EndsWith("model.sdf:4: warning: <mu2> needs <fdir1>, the direction in which <mu> counts, for "
                       "example 1 0 0: friction is 0.2 in all directions\n"));
}

TEST(SurfaceReaderTest, TorsionalFrictionIsThatOfItsPatch) {
  const auto [robot, messages] =
      ReadFriction("<torsional><coefficient>0.5</coefficient><patch_radius>0.01</patch_radius></torsional>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(messages, "");
  EXPECT_DOUBLE_EQ(robot->links[0].collisions.at(0).spinning_friction_m, 3 * std::numbers::pi / 16 * 0.005);
}

TEST(SurfaceReaderTest, APatchThatDepthMakesIsReported) {
  const auto [robot, messages] = ReadFriction(
      "<torsional><use_patch_radius>false</use_patch_radius>\n<surface_radius>0.1</surface_radius></"
      "torsional>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[0].collisions.at(0).spinning_friction_m, 0);
  EXPECT_THAT(messages, HasSubstr("warning: <torsional> counts by its <patch_radius> only: write it, in m"));
  EXPECT_THAT(messages, HasSubstr("warning: <surface_radius> in <torsional> is not used by coopdyn"));
}

TEST(SurfaceReaderTest, RollingFrictionIsBulletsWord) {
  const auto [robot, messages] = ReadFriction("<bullet><rolling_friction>0.002</rolling_friction></bullet>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(messages, "");
  EXPECT_EQ(robot->links[0].collisions.at(0).rolling_friction_m, 0.002);
}

TEST(SurfaceReaderTest, RobotsHaveNoRollingFrictionOfTheirOwn) {
  const auto [robot, messages] = ReadFriction("<ode><mu>0.5</mu></ode>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[0].collisions.at(0).rolling_friction_m, 0);
  EXPECT_EQ(robot->links[0].collisions.at(0).spinning_friction_m, 0);
}

TEST(SurfaceReaderTest, NumbersBelowZeroAreErrors) {
  EXPECT_THAT(ReadFriction("<torsional><coefficient>-1</coefficient></torsional>").messages,
              HasSubstr("model.sdf:4: error: <coefficient> "));
  EXPECT_THAT(ReadFriction("<bullet><rolling_friction>-1</rolling_friction></bullet>").messages,
              HasSubstr("<rolling_friction> must be a number from 0 to 1000"));
}

TEST(SurfaceReaderTest, AUrdfMayHaveAGrain) {
  const auto [robot, messages] = ReadUrdf(
      "<link name=\"base\"><inertial><mass value=\"1\"/><inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\" "
      "ixy=\"0\" "
      "ixz=\"0\" iyz=\"0\"/></inertial><collision><geometry><box size=\"0.2 0.2 "
      "0.2\"/></geometry></collision>"
      "</link><gazebo reference=\"base\"><mu1>0.3</mu1><mu2>0.7</mu2><fdir1>0 1 0</fdir1></gazebo>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[0].collisions.at(0).friction_along_G, Vector3::UnitY());
  EXPECT_EQ(robot->links[0].collisions.at(0).friction_across, 0.7);
}

}  // namespace
}  // namespace coopdyn

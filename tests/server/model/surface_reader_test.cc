// SPDX-License-Identifier: MIT
// <surface> of SDF: anisotropic, rolling and spinning friction, stiffness.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "tests/server/model/foreign_rig.h"

namespace coopdyn {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

const std::string kBall = "<sphere><radius>0.1</radius></sphere>";

/// A model of one link with this in <friction>; its collision is turned by 90° about z.
ForeignAnswer ReadFriction(const std::string& inside, const std::string& shape = kBall) {
  return ReadSdf(
      "<link name=\"l\"><pose>0 0 0.1 0 0 0</pose>"
      "<inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia>"
      "</inertial>\n<collision name=\"c\"><pose>0 0 0 0 0 "
      "1.5707963267948966</pose><geometry>" +
      shape + "</geometry><surface><friction>\n" + inside + "</friction></surface></collision></link>\n");
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

TEST(SurfaceReaderTest, WhatDoesNotRollHasNoUseForRollingFriction) {
  const std::string rolls = "<bullet>\n<rolling_friction>0.002</rolling_friction></bullet>";
  EXPECT_THAT(ReadFriction(rolls, kSdfBox).messages,
              EndsWith("model.sdf:5: warning: <rolling_friction> slows spheres, cylinders and capsules only: "
                       "remove it here, or write <torsional>, which slows spinning of all shapes\n"));
  EXPECT_EQ(ReadFriction("<bullet><rolling_friction>0</rolling_friction></bullet>", kSdfBox).messages, "");
  const std::string log = "<cylinder><radius>0.1</radius><length>0.1</length></cylinder>";
  EXPECT_EQ(ReadFriction(rolls, log).messages, "");
}

TEST(SurfaceReaderTest, TorsionalFrictionNeedsAPatch) {
  EXPECT_THAT(ReadFriction("<torsional><coefficient>0.5</coefficient></torsional>").messages,
              EndsWith("model.sdf:4: warning: <torsional> has no effect without the radius of the contact's "
                       "patch, in m: write it, for example <patch_radius>0.01</patch_radius>\n"));
  for (const char* none :
       {"<torsional><coefficient>0</coefficient></torsional>", "<torsional/>",
        "<torsional><coefficient>1</coefficient><patch_radius>0</patch_radius></torsional>"})
    EXPECT_EQ(ReadFriction(none).messages, "") << none;
}

TEST(SurfaceReaderTest, NumbersBelowZeroAreErrorsThatSayWhatToWrite) {
  EXPECT_THAT(ReadFriction("<torsional><coefficient>-1</coefficient></torsional>").messages,
              HasSubstr("model.sdf:4: error: <coefficient> cannot be '-1': write a number from 0 on\n"));
  EXPECT_THAT(ReadFriction("<torsional><patch_radius>-1</patch_radius></torsional>").messages,
              HasSubstr("<patch_radius> cannot be '-1': write a number from 0 on\n"));
  EXPECT_THAT(ReadFriction("<bullet><rolling_friction>-1</rolling_friction></bullet>").messages,
              HasSubstr("<rolling_friction> cannot be '-1': write a number from 0 on\n"));
  EXPECT_THAT(ReadFriction("<torsional><use_patch_radius>maybe</use_patch_radius></torsional>").messages,
              HasSubstr("<use_patch_radius> cannot be 'maybe': write true or false\n"));
}

TEST(SurfaceReaderTest, LimitsAreThoseThatCount) {
  const auto [robot, messages] = ReadFriction("<bullet><rolling_friction>1e9</rolling_friction></bullet>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[0].collisions.at(0).rolling_friction_m, 1000);  // as little does it roll
  const auto bounce = ReadSdf(
      "<link name=\"l\"><collision name=\"c\"><geometry>" + kBall +
      "</geometry><surface><bounce><restitution_coefficient>2</restitution_coefficient></bounce></surface>"
      "</collision></link>");
  EXPECT_THAT(bounce.messages,
              HasSubstr("<restitution_coefficient> cannot be '2': write a number from 0 to 1\n"));
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

/// A model of one link with this in <contact><ode>.
ForeignAnswer ReadContact(const std::string& inside) {
  return ReadSdf(
      "<link name=\"l\"><pose>0 0 0.1 0 0 0</pose>"
      "<inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia>"
      "</inertial>\n<collision name=\"c\"><geometry>" +
      kBall + "</geometry><surface><contact><ode>\n" + inside +
      "</ode></contact></surface></collision></link>\n");
}

TEST(SurfaceReaderTest, AContactMayYield) {
  const auto [robot, messages] = ReadContact("<kp>20000</kp><kd>30</kd>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(messages, "");
  EXPECT_EQ(robot->links[0].collisions.at(0).contact_stiffness_n_m, 20000);
  EXPECT_EQ(robot->links[0].collisions.at(0).contact_damping_n_s_m, 30);
}

TEST(SurfaceReaderTest, WithoutADamperAContactIsASpring) {
  const auto [robot, messages] = ReadContact("<kp>20000</kp>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[0].collisions.at(0).contact_stiffness_n_m, 20000);
  EXPECT_EQ(robot->links[0].collisions.at(0).contact_damping_n_s_m, 0);
}

TEST(SurfaceReaderTest, WhatCannotYieldIsHardAndThatIsSaid) {
  const std::pair<const char*, const char*> wrong[] = {
      {"<kd>30</kd>",
       "model.sdf:4: warning: <kd> needs <kp>, the stiffness in N/m: without it the contact is hard"},
      {"<kp>0</kp>",
       "model.sdf:4: warning: <kp> must be a number above 0, N/m, not '0': the contact is hard"},
      {"<kp>-5</kp>", "<kp> must be a number above 0, N/m, not '-5'"}};
  for (const auto& [inside, message] : wrong) {
    const auto [robot, messages] = ReadContact(inside);
    ASSERT_NE(robot, nullptr) << messages;
    EXPECT_TRUE(std::isinf(robot->links[0].collisions.at(0).contact_stiffness_n_m)) << inside;
    EXPECT_THAT(messages, HasSubstr(message));
  }
  const auto [robot, messages] = ReadContact("<kp>1000</kp><kd>-1</kd>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[0].collisions.at(0).contact_damping_n_s_m, 0);
  EXPECT_THAT(messages, HasSubstr("<kd> must be a number from 0 on, N s/m, not '-1': it is 0"));
}

TEST(SurfaceReaderTest, OtherNumbersOfGazebosSolverAreReported) {
  const auto [robot, messages] =
      ReadContact("<kp>20000</kp>\n<max_vel>0.1</max_vel><min_depth>0.001</min_depth>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("model.sdf:5: warning: <max_vel> in <ode> is not used by coopdyn"));
  EXPECT_THAT(messages, HasSubstr("<min_depth> in <ode> is not used by coopdyn"));
}

TEST(SurfaceReaderTest, APlaneIsASlabBelowItsNormal) {
  for (const Vector3& normal : {Vector3(0, 0, 1), Vector3(0, 2, 0), Vector3(1, 1, -1), Vector3(0, 0, -1)}) {
    char plane[120];
    std::snprintf(plane, sizeof(plane), "<plane><normal>%g %g %g</normal><size>2 3</size></plane>",
                  normal.x(), normal.y(), normal.z());
    const auto [robot, messages] = ReadSdf(
        "<link name=\"l\"><pose>0 0 3 0 0 0</pose><inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy>"
        "<izz>1</izz></inertia></inertial>\n<collision name=\"c\"><geometry>" +
        std::string(plane) + "</geometry></collision></link>\n");
    ASSERT_NE(robot, nullptr) << messages;
    const LinkShape& slab = robot->links[0].collisions.at(0);
    EXPECT_LT((slab.X_LG.q * Vector3::UnitZ() - normal.normalized()).norm(), 1e-12) << plane;
    EXPECT_LT((slab.X_LG.p + 0.05 * normal.normalized()).norm(), 1e-12) << plane;
  }
}

constexpr const char* kUrdfBox =
    "<link name=\"base\"><inertial><mass value=\"1\"/><inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\" "
    "ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial><collision><geometry><box size=\"0.2 0.2 0.2\"/>"
    "</geometry></collision></link>";

TEST(SurfaceReaderTest, AUrdfMayYieldWhereItTouches) {
  const auto [robot, messages] = ReadUrdf(std::string(kUrdfBox) +
                                          "<gazebo reference=\"base\"><mu1>0.3</mu1></gazebo>"
                                          "<gazebo reference=\"base\"><kp>20000</kp><kd>30</kd></gazebo>");
  ASSERT_NE(robot, nullptr) << messages;
  const LinkShape& shape = robot->links[0].collisions.at(0);
  EXPECT_EQ(shape.friction, 0.3);
  EXPECT_EQ(shape.contact_stiffness_n_m, 20000);
  EXPECT_EQ(shape.contact_damping_n_s_m, 30);
}

TEST(SurfaceReaderTest, WordsOfAGazeboReferenceMayBeAttributes) {
  const auto [robot, messages] =
      ReadUrdf(std::string(kUrdfBox) +
               "<gazebo reference=\"base\"><mu1 value=\"0.3\"/><mu2 value=\"0.7\"/>"
               "<kp value=\"20000\"/><kd value=\"30\"/></gazebo>");
  ASSERT_NE(robot, nullptr) << messages;
  const LinkShape& shape = robot->links[0].collisions.at(0);
  EXPECT_EQ(shape.friction, 0.3);
  EXPECT_EQ(shape.contact_stiffness_n_m, 20000);
  EXPECT_EQ(shape.contact_damping_n_s_m, 30);
}

TEST(SurfaceReaderTest, AWordOfAGazeboReferenceWithoutAValueIsReported) {
  const auto [robot, messages] =
      ReadUrdf(std::string(kUrdfBox) + "<gazebo reference=\"base\"><kp/></gazebo>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("<kp> in <gazebo reference>"));
}

}  // namespace
}  // namespace coopdyn

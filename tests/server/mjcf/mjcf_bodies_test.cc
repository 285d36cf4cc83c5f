// SPDX-License-Identifier: MIT
// Bodies, joints and motors of MuJoCo's files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <variant>

#include "server/geometry/mesh.h"
#include "tests/server/mjcf/mjcf_rig.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kPi = std::numbers::pi;

TEST(MjcfBodiesTest, AFreeBodyHasItsMassMomentsAndShape) {
  const auto [robot, messages] = ReadMjcfText("");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links.size(), 1u);
  EXPECT_FALSE(robot->fixed_base);
  const LinkModel& link = robot->links[0];
  EXPECT_EQ(link.name, "base");
  EXPECT_NEAR(link.mass_kg, 2, 1e-9);
  // A box of 0.2 x 0.4 x 0.6 m; MuJoCo sorts the moments.
  Vector3 moments = link.inertia_kg_m2;
  std::ranges::sort(moments);
  EXPECT_NEAR((moments - 2.0 / 12 * Vector3(0.04 + 0.16, 0.04 + 0.36, 0.16 + 0.36)).norm(), 0, 1e-9);
  ASSERT_EQ(link.collisions.size(), 1u);
  const auto* box = std::get_if<Box>(&link.collisions[0].shape);
  ASSERT_NE(box, nullptr);
  EXPECT_NEAR((box->size_m - Vector3(0.2, 0.4, 0.6)).norm(), 0, 1e-9);
}

TEST(MjcfBodiesTest, ABodyWithoutJointIsPartOfItsParent) {
  const auto [robot, messages] = ReadMjcfText(Limb("hand", ""));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links.size(), 1u);
  EXPECT_NEAR(robot->links[0].mass_kg, 2.5, 1e-9);
}

TEST(MjcfBodiesTest, AHingeHasItsAxisAnchorStopsAndDamper) {
  const auto answer = ReadMjcfText(
      Limb("leg", "<joint name=\"hip\" axis=\"0 2 0\" pos=\"0 0 .1\" range=\"-30 60\" damping=\".2\"/>"));
  const JointModel* hip = JointOf(answer, "hip");
  ASSERT_NE(hip, nullptr) << answer.messages;
  EXPECT_EQ(hip->kind, JointModel::Kind::kHinge);
  EXPECT_NEAR((hip->axis_R - Vector3::UnitY()).norm(), 0, 1e-12);
  // The body, defined at its centre, reaches 0.5 m below it, and stands on the floor.
  EXPECT_NEAR((hip->p_RJ - Vector3(0, 0, 0.3)).norm(), 0, 0.021);
  EXPECT_NEAR(hip->lower, -kPi / 6, 1e-9);
  EXPECT_NEAR(hip->upper, kPi / 3, 1e-9);
  EXPECT_EQ(hip->damping, 0.2);
}

TEST(MjcfBodiesTest, ASlideHasItsSpring) {
  const auto answer =
      ReadMjcfText(Limb("foot",
                        "<joint name=\"shock\" type=\"slide\" axis=\"0 0 1\" stiffness=\"40\" "
                        "springref=\".05\"/>"));
  const JointModel* shock = JointOf(answer, "shock");
  ASSERT_NE(shock, nullptr) << answer.messages;
  EXPECT_EQ(shock->kind, JointModel::Kind::kSlider);
  EXPECT_EQ(shock->stiffness, 40);
  EXPECT_NEAR(shock->rest, 0.05, 1e-12);
  EXPECT_FALSE(shock->has_stop());
}

TEST(MjcfBodiesTest, AJointHasItsArmature) {
  const auto answer = ReadMjcfText(Limb("foot", "<joint name=\"ankle\" axis=\"0 1 0\" armature=\".03\"/>"));
  const JointModel* ankle = JointOf(answer, "ankle");
  ASSERT_NE(ankle, nullptr) << answer.messages;
  EXPECT_EQ(ankle->armature, 0.03);
  EXPECT_THAT(answer.messages, Not(HasSubstr("armature")));
}

TEST(MjcfBodiesTest, JointsOfOneBodyFollowEachOther) {
  const auto answer = ReadMjcfText(Limb("leg",
                                        "<joint name=\"a\" axis=\"1 0 0\"/><joint name=\"b\" axis=\"0 1 0\"/>"
                                        "<joint name=\"c\" axis=\"0 0 1\"/>"));
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  const RobotModel& robot = *answer.robot;
  ASSERT_EQ(robot.joints.size(), 3u);
  EXPECT_EQ(robot.joints[0].name + robot.joints[1].name + robot.joints[2].name, "abc");
  EXPECT_EQ(robot.joints[1].parent, robot.joints[0].child);
  EXPECT_EQ(robot.joints[2].parent, robot.joints[1].child);
  double mass_kg = 0;
  for (const LinkModel& link : robot.links) mass_kg += link.mass_kg;
  EXPECT_NEAR(mass_kg, 2.5, 1e-5);
  EXPECT_THAT(answer.messages, Not(HasSubstr("mass")));
}

TEST(MjcfBodiesTest, ABallTurnsFreely) {
  const auto answer = ReadMjcfText(Limb("head", "<joint name=\"neck\" type=\"ball\" damping=\"1\"/>"));
  const JointModel* neck = JointOf(answer, "neck");
  ASSERT_NE(neck, nullptr) << answer.messages;
  EXPECT_EQ(neck->kind, JointModel::Kind::kBall);
  EXPECT_THAT(answer.messages, HasSubstr("of a ball joint are left out"));
}

TEST(MjcfBodiesTest, ABodyThatNothingFreesIsFixed) {
  const auto [robot, messages] =
      ReadAs("arm.xml", Mjcf("<worldbody><body name=\"base\" pos=\"1 2 .6\"><geom size=\".1\"/>" +
                             Limb("arm", "<joint name=\"elbow\" axis=\"0 1 0\"/>") + "</body></worldbody>"));
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_TRUE(robot->fixed_base);
  // Its origin is on the floor below the body.
  EXPECT_NEAR((robot->links[0].X_RL.p - Vector3(0, 0, 0.6)).norm(), 0, 1e-9);
}

TEST(MjcfBodiesTest, ABodyTurnedUprightKeepsItsDirections) {
  // x points down, where roll and yaw are degenerate.
  const auto [robot, messages] = ReadAs(
      "arm.xml", Mjcf("<worldbody><body name=\"base\" pos=\"0 0 1\"><geom size=\".1\"/><body name=\"arm\" "
                      "euler=\"90 90 90\"><joint name=\"j\" axis=\"0 1 0\"/><geom "
                      "size=\".1\"/></body></body></worldbody>"));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->joints.size(), 1u);
  const Quaternion q = portable::AngleAxis(kPi / 2, Vector3::UnitX()) *
                       portable::AngleAxis(kPi / 2, Vector3::UnitY()) *
                       portable::AngleAxis(kPi / 2, Vector3::UnitZ());
  EXPECT_NEAR((robot->joints[0].axis_R - q * Vector3::UnitY()).norm(), 0, 1e-7);
}

TEST(MjcfBodiesTest, ActuatorsAreMotorsWithTheirGreatestForces) {
  const std::string limbs = Limb("l1", "<joint name=\"motor\" axis=\"0 1 0\"/>") +
                            Limb("l2", "<joint name=\"servo\" axis=\"0 1 0\" range=\"-90 90\"/>") +
                            Limb("l3", "<joint name=\"forced\" axis=\"0 1 0\"/>") +
                            Limb("l4", "<joint name=\"speedy\" axis=\"0 1 0\"/>") +
                            Limb("l5", "<joint name=\"passive\" axis=\"0 1 0\"/>") +
                            Limb("l6", "<joint name=\"pulled\" axis=\"0 1 0\"/>");
  const auto answer = ReadMjcfText(
      limbs,
      "<tendon><fixed name=\"t\"><joint joint=\"pulled\" coef=\".5\"/></fixed></tendon><actuator>"
      "<motor joint=\"motor\" gear=\"10\" ctrlrange=\"-1 2\"/>"
      "<position joint=\"servo\" kp=\"5\" ctrlrange=\"-1 2\"/>"
      "<general joint=\"forced\" gear=\"3\" forcerange=\"-4 4\"/>"
      "<velocity joint=\"speedy\" kv=\"2\" ctrlrange=\"-6 6\"/>"
      "<motor tendon=\"t\" gear=\"4\" ctrlrange=\"-1 1\"/></actuator>");
  ASSERT_NE(answer.robot, nullptr) << answer.messages;
  EXPECT_NEAR(JointOf(answer, "motor")->max_effort, 20, 1e-9);
  EXPECT_NEAR(JointOf(answer, "servo")->max_effort, 15, 1e-9);
  EXPECT_NEAR(JointOf(answer, "forced")->max_effort, 12, 1e-9);
  EXPECT_NEAR(JointOf(answer, "speedy")->max_effort, 12, 1e-9);
  EXPECT_NEAR(JointOf(answer, "speedy")->max_velocity, 6, 1e-9);
  EXPECT_NEAR(JointOf(answer, "pulled")->max_effort, 2, 1e-9);
  ASSERT_EQ(answer.robot->actuators.size(), 1u);
  EXPECT_EQ(answer.robot->actuators[0].module, "joints");
  EXPECT_EQ(answer.robot->actuators[0].joints.size(), 5u);
}

TEST(MjcfBodiesTest, PositionsCountFromThePoseThatIsWritten) {
  const auto answer =
      ReadMjcfText(Limb("leg", "<joint name=\"hip\" axis=\"0 1 0\" ref=\"10\" range=\"0 30\"/>"));
  const JointModel* hip = JointOf(answer, "hip");
  ASSERT_NE(hip, nullptr) << answer.messages;
  EXPECT_NEAR(hip->lower, -kPi / 18, 1e-9);
  EXPECT_NEAR(hip->upper, kPi / 9, 1e-9);
}

TEST(MjcfBodiesTest, TheKeyframeHomeIsWhereJointsStart) {
  const auto answer = ReadMjcfText(Limb("leg", "<joint name=\"hip\" axis=\"0 1 0\" range=\"-90 90\"/>"),
                                   "<keyframe><key name=\"other\" qpos=\"0 0 1 1 0 0 0 1\"/><key "
                                   "name=\"home\" qpos=\"0 0 1 1 0 0 0 .5\"/></keyframe>");
  const JointModel* hip = JointOf(answer, "hip");
  ASSERT_NE(hip, nullptr) << answer.messages;
  EXPECT_NEAR(hip->start, 0.5, 1e-12);
}

TEST(MjcfBodiesTest, EqualitiesAreLoopsAndFollowers) {
  const std::string limbs =
      Limb("l1", "<joint name=\"a\" axis=\"0 1 0\"/>") + Limb("l2", "<joint name=\"b\" axis=\"0 1 0\"/>");
  const auto looped = ReadMjcfText(
      limbs, "<equality><connect name=\"tie\" body1=\"l1\" body2=\"l2\" anchor=\"0 0 -.2\"/></equality>");
  const JointModel* tie = JointOf(looped, "tie");
  ASSERT_NE(tie, nullptr) << looped.messages;
  EXPECT_EQ(tie->kind, JointModel::Kind::kBall);
  const auto coupled = ReadMjcfText(
      limbs,
      "<equality><joint joint1=\"b\" joint2=\"a\" polycoef=\".1 -2 0 0 0\"/></equality><actuator><motor "
      "joint=\"b\" ctrlrange=\"-1 1\"/></actuator>");
  ASSERT_NE(coupled.robot, nullptr) << coupled.messages;
  ASSERT_EQ(coupled.robot->couplings.size(), 1u);
  EXPECT_NEAR(coupled.robot->couplings[0].multiplier, -2, 1e-12);
  EXPECT_NEAR(coupled.robot->couplings[0].offset, 0.1, 1e-12);
}

TEST(MjcfBodiesTest, FrictionIsTheFirstNumberAndTheOthersAsTheDimensionsSay) {
  const auto [robot, messages] = ReadAs(
      "ball.xml",
      Mjcf("<worldbody><body><freejoint/><geom size=\".1\" friction=\".7 .02 .003\" condim=\"6\"/><geom "
           "size=\".1\" condim=\"1\"/></body></worldbody>"));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links[0].collisions.size(), 2u);
  EXPECT_NEAR(robot->links[0].collisions[0].friction, 0.7, 1e-12);
  EXPECT_NEAR(robot->links[0].collisions[0].spinning_friction_m, 0.02, 1e-9);
  EXPECT_NEAR(robot->links[0].collisions[0].rolling_friction_m, 0.003, 1e-12);
  // A contact uses the greater condim of its two geoms.
  EXPECT_EQ(robot->links[0].collisions[1].friction, 1);
}

TEST(MjcfBodiesTest, OnlyAWorldWithoutFrictionHasNone) {
  const std::string ball = "<body><freejoint/><geom size=\".1\" condim=\"1\"/></body>";
  const auto slippery =
      ReadAs("ball.xml",
             Mjcf("<worldbody><geom type=\"plane\" size=\"5 5 1\" condim=\"1\"/>" + ball + "</worldbody>"));
  ASSERT_NE(slippery.robot, nullptr) << slippery.messages;
  EXPECT_EQ(slippery.robot->links[0].collisions[0].friction, 0);
  const auto usual =
      ReadAs("ball.xml", Mjcf("<worldbody><geom type=\"plane\" size=\"5 5 1\"/>" + ball + "</worldbody>"));
  ASSERT_NE(usual.robot, nullptr) << usual.messages;
  EXPECT_EQ(usual.robot->links[0].collisions[0].friction, 1);
}

TEST(MjcfBodiesTest, WhatTouchesNothingIsOnlyDrawnAndHiddenGroupsAreNot) {
  const auto [robot, messages] = ReadMjcfText(
      "<geom size=\".1\" contype=\"0\" conaffinity=\"0\" rgba=\"1 0 0 1\" mass=\"0\"/><geom size=\".1\" "
      "group=\"3\" "
      "mass=\"0\"/>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[0].collisions.size(), 2u);
  ASSERT_EQ(robot->links[0].visuals.size(), 2u);
  EXPECT_NEAR(robot->links[0].visuals[1].color.r, 1, 1e-6);
}

TEST(MjcfBodiesTest, MeshesCollideWhereTheFileHasThem) {
  // A tetrahedron far from the origin: MuJoCo moves its vertices to its centre.
  const auto [robot, messages] = ReadAs(
      "rig.xml",
      Mjcf("<asset><mesh name=\"m\" vertex=\"1 0 0  1.2 0 0  1 .2 0  1 0 .2\"/></asset><worldbody><body "
           "pos=\"0 0 1\"><freejoint/><geom type=\"mesh\" mesh=\"m\"/></body></worldbody>"));
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links[0].collisions.size(), 1u);
  const LinkShape& shape = robot->links[0].collisions[0];
  const auto* mesh = std::get_if<Mesh>(&shape.shape);
  ASSERT_NE(mesh, nullptr);
  double least_m = 10, most_m = 0;
  for (const Vector3& v : mesh->data->vertices) {
    least_m = std::min(least_m, (shape.X_LG * v).x());
    most_m = std::max(most_m, (shape.X_LG * v).x());
  }
  EXPECT_NEAR(least_m, 1, 1e-5);
  EXPECT_NEAR(most_m, 1.2, 1e-5);
}

}  // namespace
}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

const std::string kBox = "[BOX_1]\ntype box\nsize 1 2 3\nposition 4 5 6\n";

TEST(WorldTest, BoxOfThePaper) {
  const auto [world, messages] = ReadWorldText(kBox + "orientation 0.1 0.2 0.3\nmass 2\n");
  EXPECT_EQ(messages, "");
  ASSERT_EQ(world.objects.size(), 1u);
  const WorldObject& box = world.objects[0];
  EXPECT_EQ(box.name, "BOX_1");
  EXPECT_EQ(std::get<Box>(box.shape).size_m, Vector3(1, 2, 3));
  EXPECT_EQ(box.X_WO.p, Vector3(4, 5, 6));
  EXPECT_TRUE(box.X_WO.q.isApprox(FromRollPitchYaw(0.1, 0.2, 0.3)));
  EXPECT_EQ(box.mass_kg, 2);
  EXPECT_FALSE(box.is_static());
  EXPECT_EQ(box.where.line, 1);
}

TEST(WorldTest, AQuaternionIsAKeyOfItsOwn) {
  const auto [world, messages] = ReadWorldText(kBox + "orientation quaternion 1 0 0 0\n");
  EXPECT_THAT(messages,
              HasSubstr("error: 'orientation' takes yaw, or roll pitch yaw; a quaternion w x y z is a "
                        "line of its own, without 'orientation': quaternion 1 0 0 0\n"));
  const auto [right, none] = ReadWorldText(kBox + "quaternion 1 0 0 0\n");
  EXPECT_EQ(none, "");
}

TEST(WorldTest, MassMissingOrZeroIsStatic) {
  EXPECT_TRUE(ReadWorldText(kBox).world.objects.at(0).is_static());
  EXPECT_TRUE(ReadWorldText(kBox + "mass 0").world.objects.at(0).is_static());
}

TEST(WorldTest, NegativeMassIsAnError) {
  EXPECT_EQ(ReadWorldText(kBox + "mass -1").messages,
            "test.world:5: error: 'mass' must be at least 0, not -1\n");
}

TEST(WorldTest, CylinderTakesTwoEqualDiametersAndHeight) {
  const auto [world, messages] = ReadWorldText("[C]\ntype cylinder\nsize 0.4 0.4 1\nposition 0 0\n");
  EXPECT_EQ(messages, "");
  const auto& cylinder = std::get<Cylinder>(world.objects.at(0).shape);
  EXPECT_DOUBLE_EQ(cylinder.radius_m, 0.2);
  EXPECT_DOUBLE_EQ(cylinder.length_m, 1);
  EXPECT_THAT(
      ReadWorldText("[C]\ntype cylinder\nsize 0.4 0.5 1\nposition 0 0\n").messages,
      HasSubstr("test.world:3: error: the two diameters of a cylinder must be equal, not 0.4 and 0.5"));
}

TEST(WorldTest, SphereTakesOneOrThreeEqualDiameters) {
  EXPECT_DOUBLE_EQ(
      std::get<Sphere>(ReadWorldText("[S]\ntype sphere\nsize 0.4\nposition 0 0\n").world.objects.at(0).shape)
          .radius_m,
      0.2);
  EXPECT_EQ(ReadWorldText("[S]\ntype sphere\nsize 0.4 0.4 0.4\nposition 0 0\n").messages, "");
  EXPECT_THAT(ReadWorldText("[S]\ntype sphere\nsize 0.4 0.4 0.5\nposition 0 0\n").messages,
              HasSubstr("equal"));
}

TEST(WorldTest, TwoNumbersRestOnTheFloor) {
  EXPECT_DOUBLE_EQ(ReadWorldText("[B]\ntype box\nsize 1 1 3\nposition 0 0\n").world.objects.at(0).X_WO.p.z(),
                   1.5);
  // A cylinder on its side rests at the height of its radius.
  EXPECT_NEAR(ReadWorldText("[B]\ntype cylinder\nsize 0.4 0.4 2\nposition 0 0\norientation 90deg 0 0\n")
                  .world.objects.at(0)
                  .X_WO.p.z(),
              0.2, 1e-12);
}

TEST(WorldTest, OneAngleIsYaw) {
  const auto [world, messages] = ReadWorldText(kBox + "orientation 90deg\n");
  EXPECT_EQ(messages, "");
  EXPECT_NEAR(Heading(world.objects.at(0).X_WO.q), std::numbers::pi / 2, 1e-12);
}

TEST(WorldTest, AnglesDegInFloorIsForTheWholeFile) {
  const auto [world, messages] = ReadWorldText(kBox + "orientation 90\n[FLOOR]\nsize 5 5 0.1\nangles deg\n");
  EXPECT_EQ(messages, "");
  EXPECT_NEAR(Heading(world.objects.at(0).X_WO.q), std::numbers::pi / 2, 1e-12);
  const auto rad = ReadWorldText(kBox + "orientation 1rad\n[FLOOR]\nsize 5 5 0.1\nangles deg\n");
  EXPECT_NEAR(Heading(rad.world.objects.at(0).X_WO.q), 1, 1e-12);
}

TEST(WorldTest, AngleBeyondATurnWithoutUnitDrawsAWarning) {
  EXPECT_THAT(ReadWorldText(kBox + "orientation 90\n").messages, HasSubstr("test.world:5: warning:"));
  EXPECT_THAT(ReadWorldText(kBox + "orientation 90\n").messages, HasSubstr("90deg"));
  EXPECT_EQ(ReadWorldText(kBox + "orientation 6.28\n").messages, "");
  EXPECT_EQ(ReadWorldText(kBox + "orientation 400deg\n").messages, "");
}

TEST(WorldTest, ColoursAreWordsOrNumbers) {
  EXPECT_EQ(ReadWorldText(kBox + "color Red\n").world.objects.at(0).color, (Color{1, 0, 0}));
  EXPECT_EQ(ReadWorldText(kBox + "colour 0 0.5 1\n").world.objects.at(0).color, (Color{0, 0.5, 1}));
  EXPECT_EQ(ReadWorldText(kBox + "color 0 51 255\n").world.objects.at(0).color, (Color{0, 0.2, 1}));
  EXPECT_THAT(ReadWorldText(kBox + "color gren\n").messages, HasSubstr("did you mean 'green'?"));
  EXPECT_THAT(ReadWorldText(kBox + "color 0 0 256\n").messages, HasSubstr("must be at most 255"));
}

TEST(WorldTest, FloorOfThePaper) {
  const auto [world, messages] = ReadWorldText("[FLOOR]\nsize 10 8 0.2\ncolor white\nfriction 0.7\n");
  EXPECT_EQ(messages, "");
  ASSERT_TRUE(world.floor);
  EXPECT_EQ(world.floor->length_m, 10);
  EXPECT_EQ(world.floor->width_m, 8);
  EXPECT_EQ(world.floor->height_m, 0.2);
  EXPECT_EQ(world.floor->friction, 0.7);
}

TEST(WorldTest, SizesAreAboveZeroAndSane) {
  for (const char* size :
       {"0 1 1", "-1 1 1", "1e9 1 1", "1e-30 1 1", "nan 1 1", "inf 1 1", "1 1", "1 1 1 1", ""}) {
    const auto [world, messages] =
        ReadWorldText(std::string("[B]\ntype box\nposition 0 0\nsize ") + size + "\n");
    EXPECT_THAT(messages, HasSubstr("test.world:4: error:")) << size;
    EXPECT_TRUE(world.objects.empty());
  }
}

TEST(WorldTest, RobotsBelongIntoAScenario) {
  EXPECT_THAT(ReadWorldText("[ROBOT_1]\ntype single\n").messages,
              HasSubstr("test.world:1: error: [ROBOT_1] belongs into a .scenario"));
}

TEST(WorldTest, MissingValuesAreNamed) {
  const std::string messages = ReadWorldText("[WALL_1]\n").messages;
  EXPECT_THAT(messages, HasSubstr("[WALL_1] is an object and needs 'type box'"));
  EXPECT_THAT(messages, HasSubstr("[WALL_1] needs 'size'"));
  EXPECT_THAT(messages, HasSubstr("[WALL_1] needs 'position'"));
}

TEST(WorldTest, FrictionIsAPlainNumber) {
  EXPECT_EQ(ReadWorldText(kBox + "friction 0.3\n").world.objects.at(0).friction, 0.3);
  EXPECT_THAT(ReadWorldText(kBox + "friction -1\n").messages, HasSubstr(":5: error:"));
}

TEST(WorldTest, ThingsBounceAndBeginWithASpeed) {
  const auto [world, messages] = ReadWorldText(
      kBox + "mass 1\nbounce 0.8\nvelocity 1 -2 3\nturn_rate 0 90deg 0\nrolling_friction 2mm\n");
  EXPECT_EQ(messages, "");
  const WorldObject& box = world.objects.at(0);
  EXPECT_EQ(box.restitution, 0.8);
  EXPECT_EQ(box.v_WO, Vector3(1, -2, 3));
  EXPECT_NEAR(box.w_WO.y(), std::numbers::pi / 2, 1e-12);
  EXPECT_EQ(box.rolling_friction_m, 0.002);
}

TEST(WorldTest, ATurnRateOfMoreThanATurnPerSecondIsUsual) {
  EXPECT_EQ(ReadWorldText(kBox + "mass 1\nturn_rate 7.58 0 0\n").messages, "");
}

TEST(WorldTest, WhatIsRoundHasRollingFrictionByItsRadius) {
  EXPECT_EQ(ReadWorldText(kBox + "mass 1\n").world.objects.at(0).rolling_friction_m, 0);
  const std::string ball = "[S]\ntype sphere\nsize 0.4\nposition 0 0\nmass 1\n";
  EXPECT_DOUBLE_EQ(ReadWorldText(ball).world.objects.at(0).rolling_friction_m, 0.001);
  EXPECT_EQ(ReadWorldText(ball + "rolling_friction 0\n").world.objects.at(0).rolling_friction_m, 0);
  const std::string log = "[C]\ntype cylinder\nsize 0.2 0.2 1\nposition 0 0\nmass 1\n";
  EXPECT_DOUBLE_EQ(ReadWorldText(log).world.objects.at(0).rolling_friction_m, 0.0005);
}

TEST(WorldTest, WhatNeverMovesHasNoRollingFrictionByItself) {
  const std::string pillar = "[C]\ntype cylinder\nsize 0.2 0.2 1\nposition 0 0\n";
  EXPECT_EQ(ReadWorldText(pillar).world.objects.at(0).rolling_friction_m, 0);
  EXPECT_EQ(ReadWorldText(pillar + "rolling_friction 0.1\n").world.objects.at(0).rolling_friction_m, 0.1);
}

TEST(WorldTest, AMotionThatCannotBeIsAnError) {
  EXPECT_EQ(ReadWorldText(kBox + "velocity 1 0 0\n").messages,
            "test.world:5: error: 'velocity' needs a 'mass', for example 'mass 1': without it [BOX_1] never "
            "moves\n");
  EXPECT_THAT(ReadWorldText(kBox + "mass 1\nvelocity 80 80 0\n").messages,
              HasSubstr("test.world:6: error: 'velocity' is at most 90 m/s in all, not 113"));
  EXPECT_THAT(ReadWorldText(kBox + "mass 1\nturn_rate 5\n").messages, HasSubstr("x y z in rad/s"));
  EXPECT_THAT(ReadWorldText(kBox + "bounce 1.5\n").messages, HasSubstr("must be at most 1"));
  EXPECT_THAT(ReadWorldText(kBox + "rolling_friction -1\n").messages, HasSubstr("must be at least 0"));
}

}  // namespace
}  // namespace coopdyn

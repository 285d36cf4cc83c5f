// SPDX-License-Identifier: MIT
// <ellipsoid> and <cone>: meshes, with the inertia of the solid.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "tests/server/model/foreign_rig.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

ForeignAnswer ReadRound(const std::string& geometry, const std::string& pose = "0 0 1 0 0 0") {
  return ReadSdf("<link name=\"l\"><inertial><mass>2</mass></inertial><collision name=\"c\"><pose>" + pose +
                     "</pose><geometry>" + geometry + "</geometry></collision></link>\n",
                 "1.11");
}
const std::string kEllipsoid = "<ellipsoid><radii>0.1 0.2 0.3</radii></ellipsoid>";
const std::string kCone = "<cone><radius>0.1</radius><length>0.4</length></cone>";

TEST(RoundShapesTest, AnEllipsoidHasTheInertiaOfTheSolid) {
  const auto [robot, messages] = ReadRound(kEllipsoid);
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(messages, "");
  // m/5 (b² + c²), …
  const Vector3 moments = 2.0 / 5 * Vector3(0.04 + 0.09, 0.01 + 0.09, 0.01 + 0.04);
  const LinkModel& link = robot->links.at(0);
  Vector3 found = link.X_LI.q.toRotationMatrix() * link.inertia_kg_m2.asDiagonal() *
                  link.X_LI.q.toRotationMatrix().transpose() * Vector3::Ones();
  EXPECT_NEAR((found - moments).norm(), 0, 1e-12);
  EXPECT_NEAR((link.X_LI.p - Vector3(0, 0, 1)).norm(), 0, 1e-12);
}

TEST(RoundShapesTest, AConeHasItsMassAQuarterAboveItsBase) {
  // Its tip points along x.
  const auto [robot, messages] = ReadRound(kCone, "0 0 1 0 1.5707963267948966 0");
  ASSERT_NE(robot, nullptr) << messages;
  const LinkModel& link = robot->links.at(0);
  EXPECT_NEAR((link.X_LI.p - Vector3(-0.1, 0, 1)).norm(), 0, 1e-12);
  const Matrix3 R = link.X_LI.q.toRotationMatrix();
  const Matrix3 inertia = R * link.inertia_kg_m2.asDiagonal() * R.transpose();
  EXPECT_NEAR(inertia(0, 0), 2 * 0.3 * 0.01, 1e-12);                    // 3/10 m r²
  EXPECT_NEAR(inertia(1, 1), 2 * 3.0 / 80 * (4 * 0.01 + 0.16), 1e-12);  // 3/80 m (4 r² + h²)
}

TEST(RoundShapesTest, TheirMeshesReachAsFarAsTheyDo) {
  const auto [robot, messages] = ReadRound(kEllipsoid);
  ASSERT_NE(robot, nullptr) << messages;
  const auto* mesh = std::get_if<Mesh>(&robot->links.at(0).collisions.at(0).shape);
  ASSERT_NE(mesh, nullptr);
  EXPECT_NEAR((mesh->data->half_m - Vector3(0.1, 0.2, 0.3)).norm(), 0, 2e-3);
  // The hull lies inside: 5 % of the volume is outside of it.
  const double volume_m3 = 4 * std::numbers::pi / 3 * 0.1 * 0.2 * 0.3;
  EXPECT_NEAR(mesh->data->volume_m3 / volume_m3, 1, 0.06);
}

TEST(RoundShapesTest, ARecordingsTextGivesTheSameModel) {
  for (const std::string& shape : {kEllipsoid, kCone}) {
    const auto [robot, messages] = ReadRound(shape);
    ASSERT_NE(robot, nullptr) << messages;
    Diagnostics diagnostics;
    const auto again = ReadRobotModelText(robot->text, "model.sdf", "rig", diagnostics);
    ASSERT_NE(again, nullptr) << diagnostics.ToString();
    EXPECT_EQ(again->links[0].inertia_kg_m2, robot->links[0].inertia_kg_m2);
    EXPECT_EQ(std::get<Mesh>(again->links[0].collisions[0].shape).data->vertices,
              std::get<Mesh>(robot->links[0].collisions[0].shape).data->vertices);
  }
}

TEST(RoundShapesTest, WrongSizesAreAnErrorWithTheLine) {
  EXPECT_THAT(ReadRound("<cone><radius>0.1</radius><length>-1</length></cone>").messages,
              HasSubstr("model.sdf:2: error: <cone> needs <radius> and <length>, from 0.1 mm to 1 km"));
  EXPECT_THAT(ReadRound("<ellipsoid><radii>1 nan 1</radii></ellipsoid>").messages,
              HasSubstr("error: <ellipsoid> needs <radii>, three numbers"));
}

}  // namespace
}  // namespace coopdyn

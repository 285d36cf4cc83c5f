// SPDX-License-Identifier: MIT
// Meshes of models made for other programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "server/geometry/mesh.h"
#include "tests/server/model/foreign_rig.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A cube from 0 to 1 m as an .obj file.
const char* const kCube =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

TEST(MeshTest, WhatMovesCollidesByItsHull) {
  const TempFolder folder;
  folder.Write("cube.obj", kCube);
  folder.Write("model.sdf",
               "<sdf version=\"1.6\"><model name=\"m\">" +
                   SdfLink("l", "0 0 0 0 0 0", "<mesh><uri>cube.obj</uri><scale>1 1 2</scale></mesh>") +
                   "</model></sdf>");
  const auto [robot, messages] = ReadFile(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  const LinkShape& shape = robot->links[0].collisions.at(0);
  const MeshData& data = *std::get<Mesh>(shape.shape).data;
  EXPECT_NEAR(data.volume_m3, 2, 1e-9);
  EXPECT_EQ(data.vertices.size(), 8u);
  EXPECT_NEAR((shape.X_LG.p - Vector3(0.5, 0.5, 1)).norm(), 0, 1e-6);
  EXPECT_NEAR(robot->height_m, 2, 1e-6);
  EXPECT_NEAR(robot->footprint_radius_m, std::sqrt(2.0), 1e-6);
}

/// The volume that a fixed mesh of this .obj encloses, and the messages.
std::pair<double, std::string> FixedVolume(const std::string& obj) {
  const TempFolder folder;
  folder.Write("part.obj", obj);
  folder.Write("model.sdf", "<sdf version=\"1.6\"><model name=\"m\"><static>true</static>" +
                                SdfLink("l", "0 0 0 0 0 0", "<mesh><uri>part.obj</uri></mesh>") +
                                "</model></sdf>");
  const auto [robot, messages] = ReadFile(folder, "model.sdf");
  if (robot == nullptr) return {0, messages};
  return {std::get<Mesh>(robot->links[0].collisions.at(0).shape).data->volume_m3, messages};
}

TEST(MeshTest, ASolidThatLooksInwardIsTurned) {
  const std::string cube = kCube;
  const std::string corners = cube.substr(0, cube.find('f'));
  const auto [inward, said] =
      FixedVolume(corners + "f 2 3 4 1\nf 8 7 6 5\nf 5 6 2 1\nf 6 7 3 2\nf 7 8 4 3\nf 8 5 1 4\n");
  EXPECT_NEAR(inward, 1, 1e-6);
  EXPECT_THAT(said, HasSubstr("warning: mesh 'part.obj': its triangles look inwards: they are turned"));
  EXPECT_NEAR(FixedVolume(cube).first, 1, 1e-6);
  EXPECT_THAT(FixedVolume(cube).second, Not(HasSubstr("inwards")));
  // An open mesh has no inside.
  EXPECT_THAT(FixedVolume(corners + "f 2 3 4 1\nf 8 7 6 5\n").second, Not(HasSubstr("inwards")));
}

TEST(MeshTest, ARecordedTextGivesTheSameModelWithoutFiles) {
  const TempFolder folder;
  folder.Write("cube.obj", kCube);
  folder.Write("model.sdf", "<sdf version=\"1.6\"><model name=\"m\">" +
                                SdfLink("l", "0 0 0 0 0 0", "<mesh><uri>cube.obj</uri></mesh>") +
                                "</model></sdf>");
  const auto [robot, messages] = ReadFile(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  Diagnostics diagnostics;
  const auto again = ReadRobotModelText(robot->text, "model.sdf", "m", diagnostics);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  EXPECT_EQ(std::get<Mesh>(again->links[0].collisions[0].shape).data->id,
            std::get<Mesh>(robot->links[0].collisions[0].shape).data->id);
  EXPECT_EQ(again->text, robot->text);
}

TEST(MeshTest, ACentredPartIsTheSameInARecordedText) {
  const TempFolder folder;
  std::string cube = kCube;
  for (std::size_t at = 0; (at = cube.find("v 0", at)) != std::string::npos; ++at)
    cube.replace(at, 3, at == 0 ? "v 1e-13" : "v 0.1234567");
  folder.Write("cube.obj", "g part\n" + cube);
  folder.Write(
      "model.sdf",
      "<sdf version=\"1.9\"><model name=\"rig\">" +
          SdfLink("l", "0 0 1 0 0 0",
                  "<mesh><uri>cube.obj</uri><submesh><name>part</name><center>true</center></submesh>"
                  "</mesh>") +
          "</model></sdf>");
  const auto [robot, messages] = ReadFile(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  Diagnostics diagnostics;
  const auto again = ReadRobotModelText(robot->text, "model.sdf", "rig", diagnostics);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  const LinkShape &before = robot->links[0].collisions.at(0), &after = again->links[0].collisions.at(0);
  EXPECT_EQ(before.X_LG.p, after.X_LG.p);
  EXPECT_NEAR(before.X_LG.p.norm(), 0, 1e-6);
  EXPECT_EQ(std::get<Mesh>(before.shape).data->vertices, std::get<Mesh>(after.shape).data->vertices);
  EXPECT_EQ(robot->meshes.at(0)->triangles, again->meshes.at(0)->triangles);
  EXPECT_EQ(robot->meshes.at(0)->inertia_m5, again->meshes.at(0)->inertia_m5);
}

TEST(MeshTest, AFourthNumberOfAScaleIsLeftOut) {
  const TempFolder folder;
  folder.Write("cube.obj", kCube);
  folder.Write(
      "r.urdf",
      "<robot name=\"r\">\n<link name=\"l\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" "
      "izz=\"1\"/></inertial><collision><geometry><mesh filename=\"cube.obj\" scale=\"1 1 2 1\"/>"
      "</geometry></collision></link></robot>");
  const auto [robot, messages] = ReadFile(folder, "r.urdf");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_NEAR(std::get<Mesh>(robot->links[0].collisions.at(0).shape).data->volume_m3, 2, 1e-9);
  EXPECT_THAT(messages, HasSubstr("r.urdf:2: warning: <scale> of a mesh is three numbers: the fourth of "
                                  "'1 1 2 1' is left out"));
}

TEST(MeshTest, AMissingMeshOfAModelWithElementsOfOursIsAnErrorWithItsLine) {
  const auto [robot, messages] =
      ReadSdf("<coopdyn:module name=\"pose\" type=\"pose\"/>" +
                  SdfLink("l", "0 0 0 0 0 0", "\n<mesh><uri>model://rig/none.stl</uri></mesh>"),
              "1.9\" xmlns:coopdyn=\"https://coopdyn.dev/sdf");
  EXPECT_EQ(robot, nullptr);
  EXPECT_THAT(messages, HasSubstr("model.sdf:4: error: mesh: there is no 'model://rig/none.stl'"));
}

TEST(MeshTest, AMeshOfTooManyTrianglesForAModelIsReduced) {
  // Three grids of 190,000 triangles each.
  constexpr int kSide = 309;
  std::string grid;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column)
      grid += "v " + std::to_string(row) + " " + std::to_string(column) + " " +
              std::to_string((row * column) % 7) + "\n";
  }
  for (int row = 1; row < kSide; ++row) {
    for (int column = 1; column < kSide; ++column) {
      const int here = row * kSide + column + 1;
      for (const auto& [a, b] : {std::pair(here - kSide - 1, here - 1), {here - kSide, here - kSide - 1}})
        grid += "f " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(here) + "\n";
    }
  }
  const TempFolder folder;
  std::string links;
  for (const std::string name : {"a", "b", "c"}) {
    folder.Write(name + ".obj", grid);
    links +=
        SdfLink(name, "0 0 0 0 0 0", "<mesh><uri>" + name + ".obj</uri><scale>0.01 0.01 0.01</scale></mesh>");
  }
  folder.Write("model.sdf",
               "<sdf version=\"1.6\"><model name=\"m\"><static>true</static>" + links + "</model></sdf>");
  const auto [robot, messages] = ReadFile(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, Not(HasSubstr("'a.obj'")));
  EXPECT_THAT(messages, HasSubstr("warning: 'c.obj': it has 189728 triangles: "));
  EXPECT_THAT(messages, HasSubstr("(the meshes of a model have at most 500000 together)"));
}

/// A tetrahedron of 0.2 x 0.4 x 0.6 m as a .dae file; `node`: content of its node.
std::string Collada(const std::string& up, const std::string& node = "") {
  return "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
         "version=\"1.4.1\"><asset><up_axis>" +
         up +
         "</up_axis></asset><library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array "
         "id=\"a\" count=\"12\">0 0 0 0.2 0 0 0 0.4 0 0 0 0.6</float_array><technique_common><accessor "
         "source=\"#a\" count=\"4\" stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" "
         "type=\"float\"/><param name=\"Z\" "
         "type=\"float\"/></accessor></technique_common></source><vertices "
         "id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles count=\"4\"><input "
         "semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 2 1 0 1 3 0 3 2 1 2 "
         "3</p></triangles></mesh>"
         "</geometry></library_geometries><library_visual_scenes><visual_scene id=\"s\"><node id=\"n\">" +
         node +
         "<instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes><scene>"
         "<instance_visual_scene url=\"#s\"/></scene></COLLADA>";
}

TEST(MeshTest, AColladaFileStandsWhateverAxisItCallsUp) {
  for (const std::string up : {"Y_UP", "Z_UP"}) {
    const TempFolder folder;
    folder.Write("part.dae", Collada(up));
    folder.Write("model.sdf", "<sdf version=\"1.6\"><model name=\"rig\">" +
                                  SdfLink("l", "0 0 0 0 0 0", "<mesh><uri>part.dae</uri></mesh>") +
                                  "</model></sdf>");
    const auto [robot, messages] = ReadFile(folder, "model.sdf");
    ASSERT_NE(robot, nullptr) << messages;
    double low_m = 1, high_m = -1;
    for (const Vector3& v : std::get<Mesh>(robot->links[0].collisions[0].shape).data->vertices) {
      low_m = std::min(low_m, v.z());
      high_m = std::max(high_m, v.z());
    }
    EXPECT_NEAR(high_m - low_m, 0.6, 1e-6) << up;
  }
}

TEST(MeshTest, AMirroredNodeOfAColladaFileLooksOutward) {
  const TempFolder folder;
  folder.Write("part.dae", Collada("Z_UP", "<matrix>-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>"));
  folder.Write("model.sdf", "<sdf version=\"1.6\"><model name=\"rig\"><static>true</static>" +
                                SdfLink("l", "0 0 0 0 0 0", "<mesh><uri>part.dae</uri></mesh>") +
                                "</model></sdf>");
  const auto [robot, messages] = ReadFile(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_GT(std::get<Mesh>(robot->links[0].collisions[0].shape).data->volume_m3, 0);
  EXPECT_THAT(messages, Not(HasSubstr("inwards")));
}

}  // namespace
}  // namespace coopdyn

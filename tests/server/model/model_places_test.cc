// SPDX-License-Identifier: MIT
// Where other programs' models have their files, and the substitute for a mesh that is not found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <variant>

#include "server/model/fuel.h"
#include "tests/server/model/foreign_rig.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

const char* const kWedge = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
const char* const kInertial =
    "<inertial><origin xyz=\"0 0 0.5\"/><mass value=\"12\"/><inertia ixx=\"5\" iyy=\"10\" izz=\"13\" "
    "ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";

/// A robot whose only link collides by the mesh at `uri`.
std::string UrdfOf(const std::string& uri) {
  return "<robot name=\"r\">\n<link name=\"l\">" + std::string(kInertial) +
         "<collision><geometry><mesh filename=\"" + uri + "\"/></geometry></collision></link>\n</robot>";
}

/// The model `file`, a robot with the mesh at `uri`, which must exist.
ForeignAnswer ReadWith(const TempFolder& folder, const std::string& file, const std::string& uri,
                       SearchPath path = {}) {
  folder.Write(file, UrdfOf(uri));
  path.is_strict = true;
  return ReadFile(folder, file, path);
}

TEST(ModelPlacesTest, ThePackageAroundAModelIsFoundByItsName) {
  const TempFolder folder;
  folder.Write("arms/meshes/m.obj", kWedge);
  for (const char* file : {"arms/robots/r.urdf", "arms/robots/left/r.urdf"}) {
    for (const char* uri :
         {"package://arms/meshes/m.obj", "model://arms/meshes/m.obj", "$(find arms)/meshes/m.obj",
          "file://$(find arms)/meshes/m.obj", "$(find-pkg-share arms)/meshes/m.obj"}) {
      const auto [robot, messages] = ReadWith(folder, file, uri);
      EXPECT_NE(robot, nullptr) << uri << "\n" << messages;
    }
  }
}

TEST(ModelPlacesTest, WhatAMeshInAPackageNamesIsFoundInIt) {
  const TempFolder folder;
  folder.Write("arms/meshes/m.obj", std::string("mtllib ../looks/m.mtl\nusemtl red\n") + kWedge);
  folder.Write("arms/looks/m.mtl", "newmtl red\nKd 1 0 0\n");
  const auto [robot, messages] = ReadWith(folder, "arms/robots/r.urdf", "package://arms/meshes/m.obj");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[0].visuals.size(), 0u);
  ASSERT_TRUE(robot->meshes.at(0)->color.has_value());
  EXPECT_EQ(robot->meshes.at(0)->color->at(0), 1);
}

TEST(ModelPlacesTest, ANeighbourIsFoundIfItIsAPackageOrAModel) {
  const TempFolder folder;
  folder.Write("hands/meshes/m.obj", kWedge);
  const char* const uri = "package://hands/meshes/m.obj";
  EXPECT_THAT(ReadWith(folder, "arms/robots/r.urdf", uri).messages, HasSubstr("there is no"));
  folder.Write("hands/package.xml", "<package/>");
  EXPECT_NE(ReadWith(folder, "arms/robots/r.urdf", uri).robot, nullptr);
}

TEST(ModelPlacesTest, OnesOwnPackageIsNotTakenForAnother) {
  const TempFolder folder;
  folder.Write("mine/meshes/m.obj", kWedge);
  folder.Write("mine/package.xml", "<package><name>arms</name></package>");
  EXPECT_NE(ReadWith(folder, "mine/robots/r.urdf", "package://arms/meshes/m.obj").robot, nullptr);
  EXPECT_THAT(ReadWith(folder, "mine/robots/r.urdf", "package://other/meshes/m.obj").messages,
              HasSubstr("there is no 'package://other/meshes/m.obj'"));
}

TEST(ModelPlacesTest, ModelsLieInTheFolderModelsBesideThatOfWorlds) {
  const TempFolder folder;
  folder.Write("models/hand/meshes/m.obj", kWedge);
  folder.Write("models/hand/model.config", "<model/>");
  for (const char* uri :
       {"model://hand/meshes/m.obj", "\n  model://hand/meshes/m.obj  \n", "hand/meshes/m.obj"}) {
    const auto [robot, messages] = ReadWith(folder, "worlds/r.urdf", uri);
    EXPECT_NE(robot, nullptr) << uri << "\n" << messages;
  }
}

TEST(ModelPlacesTest, FoldersFarAboveAreNoPackages) {
  const TempFolder folder;
  folder.Write("far/meshes/m.obj", kWedge);
  EXPECT_THAT(ReadWith(folder, "far/1/2/3/4/5/r.urdf", "package://far/meshes/m.obj").messages,
              HasSubstr("lies outside"));
}

TEST(ModelPlacesTest, APackageDoesNotReachOutByDotsOrLinks) {
  const TempFolder folder;
  folder.Write("secret.obj", kWedge);
  folder.Write("arms/meshes/m.obj", kWedge);
  std::filesystem::create_symlink(folder.path() / "secret.obj", folder.path() / "arms/meshes/link.obj");
  for (const char* uri : {"package://arms/../secret.obj", "package://arms/meshes/link.obj",
                          "$(find arms)/../secret.obj", "package://../secret.obj"}) {
    EXPECT_THAT(ReadWith(folder, "arms/robots/r.urdf", uri).messages, HasSubstr("error: mesh: ")) << uri;
  }
}

TEST(ModelPlacesTest, FoldersOfGazeboAndRosHoldPackagesAndAreSomeThemselves) {
  const TempFolder folder, share;
  share.Write("hands/meshes/m.obj", kWedge);
  const char* const uri = "package://hands/meshes/m.obj";
  for (const auto& one : {share.path(), share.path() / "hands"}) {
    const auto [robot, messages] = ReadWith(folder, "r.urdf", uri, {.folders = {}, .model_folders = {one}});
    EXPECT_NE(robot, nullptr) << messages;
  }
  EXPECT_EQ(ReadWith(folder, "r.urdf", uri).robot, nullptr);
}

TEST(ModelPlacesTest, AddressesOfFuelAreTakenFromItsCache) {
  const TempFolder folder, cache;
  const std::string hand = "fuel.gazebosim.org/openrobotics/models/robot hand/";
  cache.Write(hand + "9/meshes/m.obj", "no mesh");
  cache.Write(hand + "10/meshes/m.obj", kWedge);
  const SearchPath path{.folders = {}, .fuel_folders = {cache.path()}};
  for (const char* uri :
       {"https://fuel.gazebosim.org/1.0/OpenRobotics/models/Robot%20Hand/files/meshes/m.obj",
        "https://fuel.ignitionrobotics.org/1.0/openrobotics/models/Robot Hand/10/files/meshes/m.obj",
        "https://fuel.gazebosim.org/OpenRobotics/models/robot hand/tip/files/meshes/m.obj"}) {
    const auto [robot, messages] = ReadWith(folder, "r.urdf", uri, path);
    EXPECT_NE(robot, nullptr) << uri << "\n" << messages;
  }
  EXPECT_THAT(
      ReadWith(folder, "r.urdf",
               "https://fuel.gazebosim.org/1.0/OpenRobotics/models/robot hand/9/files/meshes/m.obj", path)
          .messages,
      HasSubstr("it cannot be read"));
  cache.Write("secret.obj", kWedge);
  EXPECT_EQ(ReadWith(folder, "r.urdf",
                     "https://fuel.gazebosim.org/1.0/OpenRobotics/models/robot hand/files/"
                     "%2E%2E/%2e%2e%2f..%2f..%2f..%2f..%2f..%2f../etc/passwd.obj",
                     path)
                .robot,
            nullptr);
}

TEST(ModelPlacesTest, AnIncludeOfFuelIsTheModelInItsCache) {
  const TempFolder folder, cache;
  cache.Write("fuel.gazebosim.org/me/models/post/2/model.sdf",
              "<sdf version=\"1.6\"><model name=\"post\">" +
                  SdfLink("l", "0 0 0 0 0 0", "<mesh><uri>model://Post/meshes/m.obj</uri></mesh>") +
                  "</model></sdf>");
  cache.Write("fuel.gazebosim.org/me/models/post/2/meshes/m.obj", kWedge);
  folder.Write("model.sdf",
               "<sdf version=\"1.6\"><model name=\"m\"><include><uri>"
               "https://fuel.gazebosim.org/1.0/Me/models/Post</uri></include></model></sdf>");
  const auto [robot, messages] =
      ReadFile(folder, "model.sdf", {.folders = {}, .fuel_folders = {cache.path()}, .is_strict = true});
  EXPECT_NE(robot, nullptr) << messages;
}

TEST(ModelPlacesTest, WhatFuelHasNotFetchedIsSaidWithTheCommand) {
  const TempFolder folder, cache;
  EXPECT_THAT(
      ReadWith(folder, "r.urdf", "https://fuel.gazebosim.org/1.0/Me/models/Robot%20Hand/3/files/m.obj",
               {.folders = {}, .fuel_folders = {cache.path()}})
          .messages,
      HasSubstr("(looked for in " + cache.path().string() +
                "): coopdyn fetches nothing; write gz fuel download -u "
                "'https://fuel.gazebosim.org/1.0/Me/models/Robot%20Hand/3', or copy"));
}

TEST(ModelPlacesTest, OtherAddressesAreNotFetched) {
  const TempFolder folder;
  EXPECT_THAT(ReadWith(folder, "r.urdf", "https://example.org/1.0/Me/models/Hand").messages,
              HasSubstr("is not fetched: copy it beside the model"));
  EXPECT_FALSE(FuelAddressOf("https://fuel.gazebosim.org/1.0/Me/worlds/Hall"));
  EXPECT_FALSE(FuelAddressOf("https://fuel.gazebosim.org.example.org/1.0/Me/models/Hand"));
}

TEST(ModelPlacesTest, WhatIsNowhereIsSaidOnceWithThePlaces) {
  const TempFolder folder;
  folder.Write("r.urdf", "<robot name=\"r\">\n<link name=\"a\">" + std::string(kInertial) +
                             "<collision><geometry><mesh filename=\"package://arms/m.obj\"/></geometry>"
                             "</collision></link>\n<link name=\"b\">" +
                             kInertial +
                             "<collision><geometry><mesh filename=\"package://arms/m.obj\"/></geometry>"
                             "</collision></link>\n<joint name=\"j\" type=\"continuous\"><parent "
                             "link=\"a\"/><child link=\"b\"/></joint></robot>");
  const auto [robot, messages] = ReadFile(folder, "r.urdf");
  ASSERT_NE(robot, nullptr) << messages;
  const std::string said = "r.urdf:2: warning: mesh: there is no 'package://arms/m.obj'";
  EXPECT_THAT(messages, HasSubstr(said));
  EXPECT_THAT(messages, HasSubstr("(looked for in " + folder.path().string()));
  EXPECT_EQ(messages.find("there is no"), messages.rfind("there is no")) << messages;
}

TEST(MissingMeshTest, ABoxOfTheLinksInertiaStandsForIt) {
  const auto [robot, messages] =
      ReadUrdf("<link name=\"l\">" + std::string(kInertial) +
               "<collision><origin xyz=\"9 9 9\"/><geometry><mesh filename=\"none.stl\"/></geometry>"
               "</collision><collision><geometry><mesh filename=\"no.stl\"/></geometry></collision>"
               "</link>");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links[0].collisions.size(), 1u);
  const LinkShape& shape = robot->links[0].collisions[0];
  // I = m (b² + c²) / 12 of 3 x 2 x 1 m and 12 kg is 5, 10, 13.
  EXPECT_NEAR((std::get<Box>(shape.shape).size_m - Vector3(3, 2, 1)).norm(), 0, 1e-9);
  EXPECT_THAT(messages, HasSubstr("warning: mesh: there is no 'none.stl'"));
  EXPECT_THAT(messages, HasSubstr("a box that has the link's inertia collides (--strict makes this an "
                                  "error)"));
}

TEST(MissingMeshTest, WithoutInertiaNothingCollides) {
  const auto [robot, messages] = ReadUrdf(
      "<link name=\"l\"><collision><geometry><mesh filename=\"none.stl\"/></geometry></collision>"
      "<collision><geometry><box size=\"1 1 1\"/></geometry></collision></link>");
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[0].collisions.size(), 1u);
  EXPECT_THAT(messages, HasSubstr("nothing collides, as the link has no inertia"));
}

TEST(MissingMeshTest, IsAnErrorIfStrict) {
  const TempFolder folder;
  const auto [robot, messages] = ReadWith(folder, "r.urdf", "none.stl");
  EXPECT_EQ(robot, nullptr);
  EXPECT_THAT(messages, HasSubstr("r.urdf:2: error: mesh: there is no 'none.stl'"));
}

TEST(MissingMeshTest, OfAVisualIsAWarningThoughAllElseIsStrict) {
  const TempFolder folder;
  folder.Write("r.urdf",
               "<robot name=\"r\"><link name=\"l\">" + std::string(kInertial) +
                   "<visual><geometry><mesh filename=\"none.stl\"/></geometry></visual></link></robot>");
  const auto [robot, messages] =
      ReadFile(folder, "r.urdf", {.folders = {}, .model_folders = {}, .is_strict = true});
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_THAT(messages, HasSubstr("'none.stl'"));
  EXPECT_THAT(messages, HasSubstr("(it is not drawn)"));
}

TEST(MissingMeshTest, ARecordedTextGivesTheSameBox) {
  const TempFolder folder;
  folder.Write("r.urdf", UrdfOf("none.stl"));
  const auto [robot, messages] = ReadFile(folder, "r.urdf");
  ASSERT_NE(robot, nullptr) << messages;
  Diagnostics diagnostics;
  const auto again = ReadRobotModelText(robot->text, "r.urdf", "r", diagnostics);
  ASSERT_NE(again, nullptr) << diagnostics.ToString();
  EXPECT_EQ(std::get<Box>(again->links[0].collisions.at(0).shape).size_m,
            std::get<Box>(robot->links[0].collisions.at(0).shape).size_m);
  EXPECT_EQ(again->text, robot->text);
}

}  // namespace
}  // namespace coopdyn

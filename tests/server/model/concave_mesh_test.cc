// SPDX-License-Identifier: MIT
// Concave meshes of moving links, and meshes of every format.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "server/geometry/mesh.h"
#include "server/model/mesh_file.h"
#include "tests/server/geometry/concave_solids.h"
#include "tests/server/model/foreign_rig.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string ObjOf(const Triangles& of) {
  std::string text;
  for (const Vector3& v : of.vertices)
    text += "v " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
  for (const auto& [a, b, c] : of.triangles)
    text += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " + std::to_string(c + 1) + "\n";
  return text;
}

/// A model of one link with this `<mesh …>` of hook.obj as collision.
ForeignAnswer ReadHook(const std::string& mesh, bool is_static = false, const SearchPath& path = {}) {
  const TempFolder folder;
  folder.Write("hook.obj", ObjOf(Hook()));
  folder.Write("model.sdf", "<sdf version=\"1.11\"><model name=\"m\">" +
                                std::string(is_static ? "<static>true</static>" : "") +
                                SdfLink("l", "0 0 1 0 0 0", mesh) + "</model></sdf>");
  return ReadFile(folder, "model.sdf", path);
}
const char* const kHook = "<mesh><uri>hook.obj</uri></mesh>";

TEST(ConcaveMeshTest, WhatMovesCollidesAsPartsOfOneCollision) {
  const auto [robot, messages] = ReadHook(kHook);
  ASSERT_NE(robot, nullptr) << messages;
  const auto& collisions = robot->links[0].collisions;
  ASSERT_EQ(collisions.size(), 3u);
  EXPECT_EQ(collisions[0].piece_of, -1);
  EXPECT_EQ(collisions[1].piece_of, 0);
  EXPECT_EQ(collisions[2].piece_of, 0);
  double volume_m3 = 0;
  for (const LinkShape& one : collisions) volume_m3 += std::get<Mesh>(one.shape).data->volume_m3;
  EXPECT_NEAR(volume_m3, Hook().Volume(), 1e-2 * Hook().Volume());
  EXPECT_NEAR(robot->height_m, 1.12, 1e-4);
}

TEST(ConcaveMeshTest, WhatIsFixedCollidesByItsTriangles) {
  const auto [robot, messages] = ReadHook(kHook, true);
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links[0].collisions.size(), 1u);
  EXPECT_EQ(std::get<Mesh>(robot->links[0].collisions[0].shape).data->triangles.size(), 36u);
}

TEST(ConcaveMeshTest, AMeshOfSeveralLinksIsCutOnce) {
  const TempFolder folder;
  folder.Write("hook.obj", ObjOf(Hook()));
  std::string links;
  for (const char* name : {"a", "b", "c"}) links += SdfLink(name, "0 0 1 0 0 0", kHook);
  for (const char* name : {"b", "c"})
    links += "<joint name=\"to_" + std::string(name) + "\" type=\"revolute\"><parent>a</parent><child>" +
             name + "</child><axis><xyz>0 0 1</xyz></axis></joint>";
  folder.Write("model.sdf", "<sdf version=\"1.9\"><model name=\"m\">" + links + "</model></sdf>");
  const auto [robot, messages] = ReadFile(folder, "model.sdf");
  ASSERT_NE(robot, nullptr) << messages;
  ASSERT_EQ(robot->links.size(), 3u);
  for (const LinkModel& link : robot->links) {
    ASSERT_EQ(link.collisions.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(std::get<Mesh>(link.collisions[i].shape).data,
                std::get<Mesh>(robot->links[0].collisions[i].shape).data);
  }
}

TEST(ConcaveMeshTest, ATangleOfTrianglesCollidesAsItsHullWhichIsSaid) {
  Triangles soup;
  std::mt19937 bits(1);
  const auto coordinate = [&bits] { return static_cast<double>(bits() % 1000) / 1000; };
  for (std::uint32_t i = 0; i < 40'000; ++i) {
    for (int k = 0; k < 3; ++k) soup.vertices.emplace_back(coordinate(), coordinate(), coordinate());
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const TempFolder folder, cache;
  folder.Write("soup.obj", ObjOf(soup));
  folder.Write("model.sdf", "<sdf version=\"1.9\"><model name=\"m\">" +
                                SdfLink("l", "0 0 1 0 0 0", "<mesh><uri>soup.obj</uri></mesh>") +
                                "</model></sdf>");
  SearchPath path;
  path.parts_folder = cache.path();
  for (int i = 0; i < 2; ++i) {
    const auto [robot, messages] = ReadFile(folder, "model.sdf", path);
    ASSERT_NE(robot, nullptr) << messages;
    EXPECT_EQ(robot->links[0].collisions.size(), 1u);
    EXPECT_THAT(messages,
                HasSubstr("warning: a mesh of link 'l' collides as its convex hull, as its triangles "
                          "run through each other: give its <collision> a mesh of the surface"));
  }
}

TEST(ConcaveMeshTest, OptimizationKeepsOneHullOrSaysHowManyParts) {
  const auto count = [](const std::string& mesh) {
    const auto [robot, messages] = ReadHook(mesh);
    EXPECT_THAT(messages, Not(HasSubstr("ptimization")));
    EXPECT_THAT(messages, Not(HasSubstr("convex")));
    return robot == nullptr ? 0 : robot->links[0].collisions.size();
  };
  EXPECT_EQ(count("<mesh optimization=\"convex_hull\"><uri>hook.obj</uri></mesh>"), 1u);
  const std::string parts = "<mesh optimization=\"convex_decomposition\"><uri>hook.obj</uri>";
  EXPECT_EQ(count(parts + "</mesh>"), 3u);
  EXPECT_EQ(count(parts + "<convex_decomposition><max_convex_hulls>2</max_convex_hulls><voxel_resolution>"
                          "100</voxel_resolution></convex_decomposition></mesh>"),
            2u);
}

TEST(ConcaveMeshTest, AfterAHundredMeshesOneHullStandsForEach) {
  const TempFolder folder, parts;
  folder.Write("hook.obj", ObjOf(Hook()));
  std::string links = SdfLink("l0", "0 0 1 0 0 0", kHook);
  for (int i = 1; i <= 100; ++i) {
    const std::string name = "l" + std::to_string(i);
    links += SdfLink(name, "0 0 1 0 0 0", kHook) + "<joint name=\"" + name +
             "_j\" type=\"revolute\"><parent>l0</parent><child>" + name +
             "</child><axis><xyz>0 0 1</xyz></axis></joint>";
  }
  folder.Write("model.sdf", "<sdf version=\"1.9\"><model name=\"m\">" + links + "</model></sdf>");
  SearchPath path;
  path.parts_folder = parts.path();
  const auto [robot, messages] = ReadFile(folder, "model.sdf", path);
  ASSERT_NE(robot, nullptr) << messages;
  EXPECT_EQ(robot->links[99].collisions.size(), 3u);
  EXPECT_EQ(robot->links[100].collisions.size(), 1u);
  EXPECT_THAT(messages,
              HasSubstr("more than 100 meshes that collide: from link 'l100' on each is its convex hull"));
}

TEST(ConcaveMeshTest, OptimizationThatIsWrongIsSaid) {
  EXPECT_THAT(ReadHook("<mesh optimization=\"convex_decomposition\"><uri>hook.obj</uri><convex_decomposition>"
                       "<max_convex_hulls>few</max_convex_hulls></convex_decomposition></mesh>")
                  .messages,
              HasSubstr("error: <max_convex_hulls> is a whole number from 1 on, not 'few'"));
  EXPECT_THAT(ReadHook("<mesh optimization=\"hull\"><uri>hook.obj</uri></mesh>").messages,
              HasSubstr("warning: optimization=\"hull\" of a <mesh> is not known: write convex_hull or"));
}

TEST(ConcaveMeshTest, ARecordedTextGivesTheSameParts) {
  for (const std::string mesh : {kHook, "<mesh optimization=\"convex_hull\"><uri>hook.obj</uri></mesh>"}) {
    const auto [robot, messages] = ReadHook(mesh);
    ASSERT_NE(robot, nullptr) << messages;
    Diagnostics diagnostics;
    const auto again = ReadRobotModelText(robot->text, "model.sdf", "m", diagnostics);
    ASSERT_NE(again, nullptr) << diagnostics.ToString();
    EXPECT_EQ(again->text, robot->text);
    const auto &one = robot->links[0].collisions, &other = again->links[0].collisions;
    ASSERT_EQ(one.size(), other.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(std::get<Mesh>(one[i].shape).data->id, std::get<Mesh>(other[i].shape).data->id);
      EXPECT_EQ(one[i].X_LG.p, other[i].X_LG.p);
    }
  }
}

/// A tetrahedron of 0.2 x 0.4 x 0.6 in five formats; of a .dae in cm.
std::vector<std::pair<std::string, std::string>> Tetrahedra() {
  const float corners[4][3] = {{0, 0, 0}, {0.2F, 0, 0}, {0, 0.4F, 0}, {0, 0, 0.6F}};
  const std::uint16_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  std::string obj, stl = "solid s\n",
                   ply =
                       "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                       "property float z\nelement face 4\nproperty list uchar int vertex_indices\n"
                       "end_header\n";
  std::string points, indices;
  const auto text = [&](int corner, double per) {
    std::string line;
    for (const float x : corners[corner]) line += std::to_string(per * x) + " ";
    return line;
  };
  for (int corner = 0; corner < 4; ++corner) {
    obj += "v " + text(corner, 1) + "\n";
    ply += text(corner, 1) + "\n";
    points += text(corner, 100);
  }
  for (const auto& face : faces) {
    obj += "f";
    stl += "facet normal 0 0 0\nouter loop\n";
    ply += "3";
    for (const std::uint16_t corner : face) {
      obj += " " + std::to_string(corner + 1);
      stl += "vertex " + text(corner, 1) + "\n";
      ply += " " + std::to_string(corner);
      indices += std::to_string(corner) + " ";
    }
    obj += "\n";
    stl += "endloop\nendfacet\n";
    ply += "\n";
  }
  const std::string dae =
      "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset><unit "
      "name=\"centimeter\" meter=\"0.01\"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry "
      "id=\"g\"><mesh><source id=\"p\"><float_array id=\"a\" count=\"12\">" +
      points +
      "</float_array><technique_common><accessor source=\"#a\" count=\"4\" stride=\"3\"><param name=\"X\" "
      "type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor>"
      "</technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>"
      "<triangles count=\"4\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>" +
      indices +
      "</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene "
      "id=\"s\"><node id=\"n\"><instance_geometry url=\"#g\"/></node></visual_scene>"
      "</library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
  std::string bytes(sizeof(corners) + sizeof(faces), '\0');
  std::memcpy(bytes.data(), corners, sizeof(corners));
  std::memcpy(bytes.data() + sizeof(corners), faces, sizeof(faces));
  const std::string gltf =
      "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],\"accessors\":["
      "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"min\":[0,0,0],"
      "\"max\":[0.2,0.4,0.6]},{\"bufferView\":1,\"componentType\":5123,\"count\":12,\"type\":\"SCALAR\"}],"
      "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,"
      "\"byteLength\":24}],\"buffers\":[{\"byteLength\":72,\"uri\":\"data:application/octet-stream;base64," +
      ToBase64(bytes) + "\"}]}";
  return {{"t.obj", obj}, {"t.stl", stl + "endsolid s\n"}, {"t.ply", ply}, {"t.dae", dae}, {"t.gltf", gltf}};
}

TEST(MeshFormatsTest, EachHasItsSizeAndLooksOutwardAlsoIfItIsMirrored) {
  for (const auto& [name, content] : Tetrahedra()) {
    for (const double mirror : {1.0, -1.0}) {
      const TempFolder folder;
      folder.Write(name, content);
      folder.Write("model.sdf", "<sdf version=\"1.6\"><model name=\"rig\"><static>true</static>" +
                                    SdfLink("l", "0 0 0 0 0 0",
                                            "<mesh><uri>" + name + "</uri><scale>1 1 " +
                                                std::to_string(mirror) + "</scale></mesh>") +
                                    "</model></sdf>");
      const auto [robot, messages] = ReadFile(folder, "model.sdf");
      ASSERT_NE(robot, nullptr) << name << messages;
      const LinkShape& shape = robot->links[0].collisions.at(0);
      const MeshData& data = *std::get<Mesh>(shape.shape).data;
      EXPECT_NEAR(data.volume_m3, 0.008, 1e-6) << name << mirror;
      EXPECT_LT((data.half_m - Vector3(0.1, 0.2, 0.3)).norm(), 1e-6) << name;
      EXPECT_LT((shape.X_LG.p - Vector3(0.1, 0.2, 0.3 * mirror)).norm(), 1e-6) << name << mirror;
      EXPECT_THAT(messages, Not(HasSubstr("inwards"))) << name << mirror;
    }
  }
}

}  // namespace
}  // namespace coopdyn

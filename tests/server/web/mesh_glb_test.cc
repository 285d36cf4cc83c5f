// SPDX-License-Identifier: MIT
#include "server/web/mesh_glb.h"

#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <cstring>

#include "server/geometry/mesh.h"
#include "tests/server/sensing/sample_frame.h"

namespace coopdyn::mesh_glb {
namespace {

/// A robot with a square of two triangles: the first has a texture, the second a colour.
std::shared_ptr<RobotModel> HalfPainted(std::shared_ptr<const Image> image) {
  Vector3 middle;
  auto data = std::make_shared<MeshData>(MakeMesh(
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {3, 4, 5}}, middle));
  auto skin = std::make_shared<MeshSkin>();
  skin->corners = {{{0, 0}, 0}, {{1, 0}, 0}, {{1, 0.75F}, 0}, {{}, 1}, {{}, 1}, {{}, 1}};
  skin->materials = {{{0.5, 0.5, 0.5}, {1, 1, 1}, std::move(image)}, {{0.25, 0.5, 0.75}, {1, 1, 1}, nullptr}};
  data->skin = std::move(skin);
  data->color = {0.5, 0.5, 0.5};
  data->id = 0xabc;
  auto model = SampleRobot();
  model->links[0].visuals = {{Mesh{data.get()}, {}, {0.5, 0.5, 0.5}}};
  model->meshes.push_back(std::move(data));
  return model;
}

/// The JSON of a glb file, and its binary part.
std::pair<boost::json::value, std::string> Parts(const std::string& glb) {
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, sizeof length);
  return {boost::json::parse(std::string_view(glb).substr(20, length)), glb.substr(20 + length + 8)};
}

TEST(MeshGlbTest, TrianglesWithATextureNameIt) {
  const auto image = std::make_shared<Image>();
  const auto frame = SampleWorld().Robot(At(0, 0), HalfPainted(image)).MakeFrame();
  const auto [gltf, binary] = Parts(MeshGlb(*frame->scene, 0xabc));
  const auto& primitives = gltf.at_pointer("/meshes/0/primitives").as_array();
  ASSERT_EQ(primitives.size(), 2U);
  EXPECT_TRUE(primitives[0].at("attributes").as_object().contains("COLOR_0"));
  EXPECT_TRUE(primitives[1].at("attributes").as_object().contains("TEXCOORD_0"));
  EXPECT_EQ(primitives[1].at("material"), 0);
  EXPECT_EQ(gltf.at_pointer("/materials/0/extras/texture"), "mesh:0000000000000abc:0");
  EXPECT_EQ(MeshTexture(*frame->scene, "mesh:0000000000000abc:0"), image);
}

TEST(MeshGlbTest, CoordinatesOfTexturesBeginAtTheUpperLeft) {
  const auto frame = SampleWorld().Robot(At(0, 0), HalfPainted(std::make_shared<Image>())).MakeFrame();
  const auto [gltf, binary] = Parts(MeshGlb(*frame->scene, 0xabc));
  const auto accessor =
      gltf.at_pointer("/meshes/0/primitives/1/attributes/TEXCOORD_0").to_number<std::size_t>();
  const auto view = gltf.at("accessors").at(accessor).at("bufferView").to_number<std::size_t>();
  const auto begin = gltf.at("bufferViews").at(view).at("byteOffset").to_number<std::size_t>();
  float v[2];  // of the first and the third corner
  std::memcpy(&v[0], binary.data() + begin + 4, 4);
  std::memcpy(&v[1], binary.data() + begin + 2 * 8 + 4, 4);
  EXPECT_EQ(v[0], 1);
  EXPECT_EQ(v[1], 0.25F);
}

TEST(MeshGlbTest, UnknownTexturesAreNone) {
  const auto frame = SampleWorld().Robot(At(0, 0), HalfPainted(std::make_shared<Image>())).MakeFrame();
  for (const char* name :
       {"mesh:", "mesh:abc", "mesh:abc:", "mesh:abc:1", "mesh:abc:2", "mesh:abc:0x", "mesh:def:0", "x"})
    EXPECT_EQ(MeshTexture(*frame->scene, name), nullptr) << name;
}

}  // namespace
}  // namespace coopdyn::mesh_glb

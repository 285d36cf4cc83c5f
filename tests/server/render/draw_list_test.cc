// SPDX-License-Identifier: MIT
#include "server/render/draw_list.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "tests/server/sensing/sample_frame.h"

namespace coopdyn {
namespace {

std::size_t Count(const DrawList& list, MeshId id) {
  return list.meshes[static_cast<std::size_t>(id)].size();
}

DrawList ListFor(const Frame& frame, ImageRequest request) {
  return MakeDrawList(frame, request, CameraFor(request, *frame.scene));
}

ImageRequest From(const Vector3& eye, const Vector3& look) {
  ImageRequest request;
  request.eye_m = eye;
  request.look_m = look;
  return request;
}

Eigen::Vector3d ToVector(const std::array<float, 3>& v) {
  return {v[0], v[1], v[2]};
}

TEST(MeshesTest, TrianglesFaceOutwardsAndAgreeWithTheirNormals) {
  const Meshes meshes = MakeMeshes();
  for (std::size_t i = 0; i < meshes.indices.size(); i += 3) {
    const MeshVertex& a = meshes.vertices[meshes.indices[i]];
    const MeshVertex& b = meshes.vertices[meshes.indices[i + 1]];
    const MeshVertex& c = meshes.vertices[meshes.indices[i + 2]];
    const Eigen::Vector3d face =
        (ToVector(b.position) - ToVector(a.position)).cross(ToVector(c.position) - ToVector(a.position));
    ASSERT_GT(face.norm(), 0) << "triangle " << i / 3;
    for (const MeshVertex* v : {&a, &b, &c})
      ASSERT_GT(face.dot(ToVector(v->normal)), 0) << "triangle " << i / 3;
  }
}

TEST(MeshesTest, EnclosedVolumesAreThoseOfTheShapes) {
  const Meshes meshes = MakeMeshes();
  const auto volume = [&](MeshId id) {
    const MeshRange range = meshes.ranges[static_cast<std::size_t>(id)];
    double sum = 0;
    for (std::uint32_t i = range.first_index; i < range.first_index + range.count; i += 3) {
      const auto p = [&](std::uint32_t k) {
        return ToVector(meshes.vertices[meshes.indices[i + k]].position);
      };
      sum += p(0).dot(p(1).cross(p(2))) / 6;
    }
    return sum;
  };
  EXPECT_NEAR(volume(MeshId::kBox), 1, 1e-6);
  EXPECT_NEAR(volume(MeshId::kCylinder40), std::numbers::pi / 4, 0.005);
  EXPECT_NEAR(volume(MeshId::kSphere32), std::numbers::pi / 6, 0.01);
}

TEST(DrawListTest, ViewsShowAWordOfColourCalmlyAndCamerasOfRobotsAsWritten) {
  const auto frame = SampleWorld().Mark(0, 0).MakeFrame();
  ImageRequest request = From({-3, 0, 1}, {0, 0, 0.3});
  const auto ball = [&] {
    const DrawList list = ListFor(*frame, request);
    return list.meshes[static_cast<std::size_t>(MeshId::kSphere16)].at(0).color;
  };
  EXPECT_LT(ball()[0], 0.9F);
  EXPECT_GT(ball()[1], 0.1F);
  request.shot.emplace();
  EXPECT_EQ(ball(), (std::array<float, 3>{1, 0, 0}));
}

TEST(DrawListTest, OnlyViewsHaveFlagsAtTargets) {
  const auto frame = SampleWorld().Mark(0, 0).MakeFrame();
  ImageRequest request = From({-3, 0, 1}, {0, 0, 0.3});
  EXPECT_EQ(Count(ListFor(*frame, request), MeshId::kBox), 1U);
  request.shot.emplace();
  EXPECT_EQ(Count(ListFor(*frame, request), MeshId::kBox), 0U);
}

TEST(DrawListTest, NearShapesAreFinerThanFarOnes) {
  const auto frame = SampleWorld().Object(Sphere{0.3}, {{0, 0, 0.3}, Quaternion::Identity()}).MakeFrame();
  EXPECT_EQ(Count(ListFor(*frame, From({-2, 0, 1}, {0, 0, 0.3})), MeshId::kSphere32), 1U);
  EXPECT_EQ(Count(ListFor(*frame, From({-10, 0, 1}, {0, 0, 0.3})), MeshId::kSphere16), 1U);
  EXPECT_EQ(Count(ListFor(*frame, From({-80, 0, 1}, {0, 0, 0.3})), MeshId::kSphere8), 1U);
}

TEST(DrawListTest, WhatIsOutOfThePictureIsLeftOut) {
  const auto frame = SampleWorld().Object(Box{{1, 1, 1}}, {{0, 0, 0.5}, Quaternion::Identity()}).MakeFrame();
  EXPECT_EQ(Count(ListFor(*frame, From({-5, 0, 1}, {0, 0, 1})), MeshId::kBox), 1U);
  EXPECT_EQ(Count(ListFor(*frame, From({-5, 0, 1}, {-9, 0, 1})), MeshId::kBox), 0U);
}

TEST(DrawListTest, ARobotFarAwayIsOneCylinderWithoutName) {
  const auto frame = SampleWorld().Robot(At(0, 0)).MakeFrame();
  const DrawList list = ListFor(*frame, From({-150, 0, 30}, {0, 0, 0}));
  EXPECT_EQ(Count(list, MeshId::kCylinder8), 1U);
  EXPECT_EQ(Count(list, MeshId::kBox), 0U);
  EXPECT_TRUE(list.labels.empty());
}

TEST(DrawListTest, ARobotWithoutMarkGetsOneAhead) {
  const auto frame = SampleWorld().Robot(At(0, 0, std::numbers::pi / 2)).MakeFrame();
  const DrawList list = ListFor(*frame, From({-2, 0, 2}, {0, 0, 0}));
  ASSERT_EQ(Count(list, MeshId::kBox), 1U);
  const MeshInstance& mark = list.meshes[static_cast<std::size_t>(MeshId::kBox)][0];
  EXPECT_GT(mark.position[1], 0.05F);
  EXPECT_NEAR(mark.position[0], 0, 1e-6);
}

TEST(DrawListTest, NamesComeFarthestFirstAndOnlyIfAskedFor) {
  const auto frame = SampleWorld().Robot(At(0, 0)).Robot(At(2, 0)).MakeFrame();
  ImageRequest request = From({-3, 0, 2}, {1, 0, 0});
  const DrawList list = ListFor(*frame, request);
  ASSERT_EQ(list.labels.size(), 2U);
  EXPECT_EQ(list.labels[0].text, "robot2");
  request.show_names = false;
  EXPECT_TRUE(ListFor(*frame, request).labels.empty());
}

TEST(DrawListTest, RaysOnlyIfAskedFor) {
  const auto frame = SampleWorld().Robot(At(0, 0)).MakeFrame();
  ImageRequest request = From({0, 0, 12}, {0, 0, 0});
  EXPECT_TRUE(ListFor(*frame, request).sensor_marks.empty());
  request.show_rays = true;
  EXPECT_EQ(ListFor(*frame, request).sensor_marks.size(), 3U * 6U);  // two triangles each
}

}  // namespace
}  // namespace coopdyn

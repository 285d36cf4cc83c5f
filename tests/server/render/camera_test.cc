// SPDX-License-Identifier: MIT
#include "server/render/camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/server/sensing/sample_frame.h"

namespace coopdyn {
namespace {

Camera Viewpoint(const Vector3& eye, const Vector3& look) {
  Camera camera;
  camera.eye_W = eye;
  camera.look_W = look;
  return camera;
}

TEST(CameraTest, TheLookPointIsInTheMiddle) {
  const Camera camera = Viewpoint({1, -2, 3}, {4, 0, 0.5});
  const ProjectedPoint p = Frustum(camera, 640, 480).Pixel(camera.look_W);
  EXPECT_NEAR(p.x_px, 320, 1e-9);
  EXPECT_NEAR(p.y_px, 240, 1e-9);
  EXPECT_NEAR(p.depth_m, (camera.look_W - camera.eye_W).norm(), 1e-9);
}

TEST(CameraTest, LeftOfTheWayIsLeftInThePictureAndUpIsUp) {
  const Camera camera = Viewpoint({-5, 0, 1}, {0, 0, 1});
  EXPECT_LT(Frustum(camera, 640, 480).Pixel({0, 1, 1}).x_px, 320);
  EXPECT_LT(Frustum(camera, 640, 480).Pixel({0, 0, 2}).y_px, 240);
}

TEST(CameraTest, TheFieldOfViewIsTheFullVerticalAngle) {
  Camera camera = Viewpoint({-5, 0, 0}, {0, 0, 0});
  camera.fov_rad = 0.8;
  const double edge_m = 5 * std::tan(0.4);
  EXPECT_NEAR(Frustum(camera, 640, 480).Pixel({0, 0, edge_m}).y_px, 0, 1e-9);
  EXPECT_NEAR(Frustum(camera, 640, 480).Pixel({0, -edge_m * 640 / 480, 0}).x_px, 640, 1e-9);
}

TEST(CameraTest, StraightDownHasYUp) {
  const Camera camera = Viewpoint({0, 0, 10}, {0, 0, 0});
  EXPECT_LT(Frustum(camera, 640, 480).Pixel({0, 1, 0}).y_px, 240);
  EXPECT_GT(Frustum(camera, 640, 480).Pixel({1, 0, 0}).x_px, 320);
}

TEST(CameraTest, WhatIsBehindHasNegativeDepth) {
  EXPECT_LT(Frustum(Viewpoint({0, 0, 1}, {1, 0, 1}), 640, 480).Pixel({-1, 0, 1}).depth_m, 0);
}

TEST(CameraTest, TheDefaultFramesAllThatStandsThere) {
  const auto frame = SampleWorld()
                         .Robot(coopdyn::At(-3, 1))
                         .Robot(coopdyn::At(5, -2))
                         .Mark(2, 4)
                         .Object(Box{{0.1, 6, 1}}, {{7, 0, 0.5}, Quaternion::Identity()})
                         .MakeFrame();
  for (const auto& [width, height] : {std::pair{640, 480}, {1280, 300}, {200, 900}}) {
    const Camera camera = DefaultCamera(*frame->scene, 0.8, width, height);
    double min_x = 1e9, max_x = -1e9, min_y = 1e9, max_y = -1e9;
    for (const Vector3& p : {Vector3(-3, 1, 0), Vector3(5, -2, 0), Vector3(2, 4, 0), Vector3(7, 3, 0),
                             Vector3(7, -3, 0), Vector3(7, 3, 1), Vector3(7, -3, 1)}) {
      const ProjectedPoint at = Frustum(camera, width, height).Pixel(p);
      EXPECT_GT(at.depth_m, 0);
      min_x = std::min(min_x, at.x_px);
      max_x = std::max(max_x, at.x_px);
      min_y = std::min(min_y, at.y_px);
      max_y = std::max(max_y, at.y_px);
    }
    EXPECT_GE(min_x, 0);
    EXPECT_GE(min_y, 0);
    EXPECT_LE(max_x, width);
    EXPECT_LE(max_y, height);
    EXPECT_GT(std::max((max_x - min_x) / width, (max_y - min_y) / height), 0.6)
        << width << " x " << height << ": " << min_x << " " << max_x << " " << min_y << " " << max_y;
  }
}

TEST(CameraTest, AnEmptyWorldShowsItsFloor) {
  const auto frame = SampleWorld().Floor(6, 4).MakeFrame();
  const Camera camera = DefaultCamera(*frame->scene, 0.8, 640, 480);
  for (const Vector3& corner : {Vector3(3, 2, 0), Vector3(-3, 2, 0), Vector3(3, -2, 0), Vector3(-3, -2, 0)}) {
    const ProjectedPoint at = Frustum(camera, 640, 480).Pixel(corner);
    EXPECT_TRUE(at.x_px > 0 && at.x_px < 640 && at.y_px > 0 && at.y_px < 480);
  }
}

TEST(CameraTest, TheScenarioMaySayTheView) {
  const auto frame_of = [](const View& view) {
    auto frame = SampleWorld().Floor(6, 4).MakeFrame();
    auto scene = std::make_shared<Scene>(*frame->scene);
    auto scenario = scene->scenario == nullptr ? std::make_shared<Scenario>()
                                               : std::make_shared<Scenario>(*scene->scenario);
    scenario->view = view;
    scene->scenario = scenario;
    return DefaultCamera(*scene, 0.8, 640, 480);
  };
  const Camera placed = frame_of({View::From::kWhole, Vector3(3, -2, 2), Vector3(0, 0, 0.2)});
  EXPECT_EQ(placed.eye_W, Vector3(3, -2, 2));
  EXPECT_EQ(placed.look_W, Vector3(0, 0, 0.2));
  const Camera top = frame_of({View::From::kTop, {}, {}}), front = frame_of({View::From::kFront, {}, {}});
  EXPECT_LT((top.eye_W - top.look_W).head<2>().norm(), 0.01 * top.eye_W.z());
  EXPECT_GT(front.eye_W.x() - front.look_W.x(), 3 * front.eye_W.z());
  EXPECT_NEAR(front.eye_W.y(), 0, 1e-9);
}

TEST(CameraTest, TheDefaultDoesNotFollowTheRobots) {
  const auto before = SampleWorld().Robot(coopdyn::At(0, 0)).Mark(3, 0).MakeFrame();
  auto after = SampleWorld().Robot(coopdyn::At(0, 0)).Mark(3, 0).MakeFrame();
  for (BodyState& body : after->bodies) body.p_WB.x() += 2;
  EXPECT_EQ(DefaultCamera(*before->scene, 0.8, 640, 480).eye_W,
            DefaultCamera(*after->scene, 0.8, 640, 480).eye_W);
}

TEST(CameraTest, WhatARequestLeavesOutComesFromTheDefault) {
  const auto frame = SampleWorld().Robot(coopdyn::At(0, 0)).Mark(3, 0).MakeFrame();
  const Camera standard = CameraFor({}, *frame->scene);
  ImageRequest request;
  request.eye_m = Vector3(-5, -5, 5);
  EXPECT_EQ(CameraFor(request, *frame->scene).eye_W, *request.eye_m);
  EXPECT_EQ(CameraFor(request, *frame->scene).look_W, standard.look_W);
  request.eye_m.reset();
  request.look_m = Vector3(1, 2, 0);
  EXPECT_EQ(CameraFor(request, *frame->scene).look_W, *request.look_m);
  EXPECT_NEAR(
      (CameraFor(request, *frame->scene).eye_W - *request.look_m - (standard.eye_W - standard.look_W)).norm(),
      0, 1e-9);
  request.look_m.reset();
  request.eye_m = standard.look_W;  // the eye at the point looked at
  EXPECT_GT((CameraFor(request, *frame->scene).eye_W - CameraFor(request, *frame->scene).look_W).norm(), 0.1);
}

TEST(FrustumTest, SeesSpheresThatReachIntoThePicture) {
  Camera camera = Viewpoint({0, 0, 0}, {1, 0, 0});
  camera.fov_rad = 0.8;
  const Frustum frustum(camera, 480, 480);
  const double edge_m = 10 * std::tan(0.4);
  EXPECT_TRUE(frustum.Sees({10, 0, 0}, 0.1));
  EXPECT_FALSE(frustum.Sees({-10, 0, 0}, 0.1));
  EXPECT_FALSE(frustum.Sees({10, edge_m + 0.5, 0}, 0.4));
  EXPECT_TRUE(frustum.Sees({10, edge_m + 0.5, 0}, 0.6));
  EXPECT_FALSE(frustum.Sees({200, 0, 0}, 1));
}

TEST(FrustumTest, TellsSizesOnScreen) {
  Camera camera = Viewpoint({0, 0, 0}, {1, 0, 0});
  const Frustum frustum(camera, 640, 480);
  const double px =
      Frustum(camera, 640, 480).Pixel({5, 0, -0.5}).y_px - Frustum(camera, 640, 480).Pixel({5, 0, 0.5}).y_px;
  EXPECT_NEAR(frustum.PixelsPerMetre({5, 0, 0}), px, 1e-9);
}

}  // namespace
}  // namespace coopdyn

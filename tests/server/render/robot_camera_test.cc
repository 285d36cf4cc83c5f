// SPDX-License-Identifier: MIT
// Pictures of robots' cameras, against geometry.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numeric>
#include <random>

#include "server/render/picture_maker.h"
#include "server/sensing/readings.h"
#include "server/state/pose_codec.h"
#include "tests/server/sensing/sample_frame.h"

namespace coopdyn::robot_camera {
namespace {

using testing::HasSubstr;

constexpr double kEyeHeight_m = 0.4;

CameraModel Eye(int width = 320, int height = 240) {
  CameraModel camera;
  camera.mount.X_LS.p = {0.2, 0, kEyeHeight_m};
  camera.width = width;
  camera.height = height;
  camera.near_m = 0.05;
  camera.far_m = 20;
  return camera;
}

Pose Stands(double x, double y, double z) {
  return {{x, y, z}, Quaternion::Identity()};
}

/// A robot without shapes that carries `camera`.
std::shared_ptr<const RobotModel> Seer(const CameraModel& camera) {
  auto model = std::make_shared<RobotModel>(*SampleRobot());
  for (LinkModel& link : model->links) {
    link.visuals.clear();
    link.X_RL = {};
  }
  model->AddSensor("eye", camera);
  return model;
}

std::size_t SensorOf(const Frame& frame) {
  return ModelOf(frame, 0).IndexOf<CameraModel>();
}

ImageResult Look(const Frame& frame, ImageFormat format, RendererKind renderer = RendererKind::kOsmesa) {
  ImageRequest request;
  request.format = format;
  request.shot = CameraShot{nullptr, 0, SensorOf(frame)};
  ImageResult result = PictureMaker(renderer).Make(frame, request);
  EXPECT_EQ(result.error, "");
  return result;
}

template <typename Value>
std::vector<Value> Values(const ImageResult& result) {
  std::vector<Value> values(result.bytes->size() / sizeof(Value));
  std::memcpy(values.data(), result.bytes->data(), result.bytes->size());
  return values;
}

/// Where the first robot's camera sees a point of the world: x right, y down, px; and the point's depth.
Vector3 Project(const Frame& frame, const Vector3& p_W) {
  const auto& model = *ModelOf(frame, 0).Find<CameraModel>();
  const Vector3 p_S = MountPose(frame, 0, model.mount).Inverse() * p_W;
  const double f = model.focal_px();
  return {model.width / 2.0 - f * p_S.y() / p_S.x(), model.height / 2.0 - f * p_S.z() / p_S.x(), p_S.x()};
}

TEST(RobotCameraTest, ABoxsOutlineIsWherePinholeSaysWithinAPixel) {
  // A box whose front face is perpendicular to the view.
  const auto frame = SampleWorld()
                         .Robot(At(0, 0), Seer(Eye()))
                         .Object(Box{{0.4, 0.8, 0.6}}, Stands(2.2, 0.3, 0.5))
                         .MakeFrame();
  const auto numbers = Values<std::uint16_t>(Look(*frame, ImageFormat::kSegmentation));
  int left = 320, right = -1, top = 240, bottom = -1;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      if (numbers[static_cast<std::size_t>(y * 320 + x)] != 2) continue;
      left = std::min(left, x);
      right = std::max(right, x);
      top = std::min(top, y);
      bottom = std::max(bottom, y);
    }
  }
  const Vector3 upper_left = Project(*frame, {2.0, 0.7, 0.8}),
                lower_right = Project(*frame, {2.0, -0.1, 0.2});
  EXPECT_NEAR(left, upper_left.x(), 1);
  EXPECT_NEAR(top, upper_left.y(), 1);
  EXPECT_NEAR(right + 1, lower_right.x(), 1);
  EXPECT_NEAR(bottom + 1, lower_right.y(), 1);
}

TEST(RobotCameraTest, DepthIsThatOfTheFaceAndOfTheFloorWithinAMillimetre) {
  const auto frame = SampleWorld()
                         .Robot(At(0, 0), Seer(Eye()))
                         .Object(Box{{0.4, 0.8, 0.6}}, Stands(2.2, 0.3, 0.5))
                         .MakeFrame();
  const auto depth_m = Values<float>(Look(*frame, ImageFormat::kDepth));
  const auto numbers = Values<std::uint16_t>(Look(*frame, ImageFormat::kSegmentation));
  const double f = Eye().focal_px();
  int faces = 0, floors = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const auto at = static_cast<std::size_t>(y * 320 + x);
      const double depth = static_cast<double>(depth_m[at]);
      if (numbers[at] == 1) {
        // Intersects the ray through the pixel's centre with z = 0.
        const double expected = kEyeHeight_m * f / (y + 0.5 - 120);
        if (expected > 6) continue;
        EXPECT_NEAR(depth, expected, 1e-3) << x << " " << y;
        ++floors;
      } else if (numbers[at] == 2 && std::abs(depth - 1.8) < 0.05) {
        EXPECT_NEAR(depth, 1.8, 1e-3);
        ++faces;
      } else if (numbers[at] == 0) {
        EXPECT_TRUE(std::isinf(depth));
      }
    }
  }
  EXPECT_GT(faces, 8000);
  EXPECT_GT(floors, 15000);
}

TEST(RobotCameraTest, AColumnsDepthIsWithinAMillimetreAwayFromItsEdges) {
  constexpr double kRadius_m = 0.25, kAhead_m = 1.5, kLeft_m = 0.3;
  const auto frame = SampleWorld()
                         .Robot(At(0, 0), Seer(Eye()))
                         .Object(Cylinder{kRadius_m, 0.8}, Stands(kAhead_m + 0.2, kLeft_m, 0.4))
                         .MakeFrame();
  const auto depth_m = Values<float>(Look(*frame, ImageFormat::kDepth));
  const double f = Eye().focal_px();
  int seen = 0;
  for (int x = 0; x < 320; ++x) {
    const double left = (160 - x - 0.5) / f, a = 1 + left * left;
    const double along = (kAhead_m + left * kLeft_m) / a;
    const double miss_m = std::hypot(along - kAhead_m, along * left - kLeft_m);
    if (miss_m > 0.98 * kRadius_m) continue;
    const double expected = along - std::sqrt((kRadius_m * kRadius_m - miss_m * miss_m) / a);
    ASSERT_NEAR(static_cast<double>(depth_m[static_cast<std::size_t>(120 * 320 + x)]), expected, 1e-4) << x;
    ++seen;
  }
  EXPECT_GT(seen, 60);
}

TEST(RobotCameraTest, ABallsDepthIsWithinAMillimetreAwayFromItsEdge) {
  constexpr double kRadius_m = 0.3;
  const Vector3 p_WO(1.7, 0.2, 0.5);
  const auto frame =
      SampleWorld().Robot(At(0, 0), Seer(Eye())).Object(Sphere{kRadius_m}, {p_WO, {}}).MakeFrame();
  const auto depth_m = Values<float>(Look(*frame, ImageFormat::kDepth));
  const Vector3 p_SO = p_WO - Vector3(0.2, 0, kEyeHeight_m);
  const double f = Eye().focal_px();
  int seen = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      // The first intersection of the ray through the pixel's centre with the ball; the ray has depth 1 per
      // unit.
      const Vector3 ray(1, (160 - x - 0.5) / f, (120 - y - 0.5) / f);
      const double along = ray.dot(p_SO) / ray.squaredNorm(), miss_m = (along * ray - p_SO).norm();
      if (miss_m > 0.98 * kRadius_m) continue;
      const double expected =
          along - std::sqrt((kRadius_m * kRadius_m - miss_m * miss_m) / ray.squaredNorm());
      ASSERT_NEAR(static_cast<double>(depth_m[static_cast<std::size_t>(y * 320 + x)]), expected, 1e-4)
          << x << " " << y;
      ++seen;
    }
  }
  EXPECT_GT(seen, 5000);
}

TEST(RobotCameraTest, TheLegendNamesWhatIsSeenAndNothingElse) {
  const auto frame = SampleWorld()
                         .Robot(At(0, 0), Seer(Eye()))
                         .Robot(At(3, 0.5))
                         .Object(Box{{0.4, 0.8, 0.6}}, Stands(2.2, -0.7, 0.5))
                         .Object(Box{{0.4, 0.8, 0.6}}, Stands(-2.2, 0, 0.5))  // behind
                         .MakeFrame();
  const std::string& legend = Look(*frame, ImageFormat::kSegmentation).legend;
  EXPECT_THAT(legend, HasSubstr("1=floor"));
  EXPECT_THAT(legend, HasSubstr("2=" + frame->scene->objects[0].object.name));
  EXPECT_THAT(legend, HasSubstr("5=" + frame->scene->robots[1].entry.name));
  EXPECT_EQ(legend.find("3="), std::string::npos);
}

TEST(RobotCameraTest, WhatIsNearerThanTheNearestOrBeyondTheFurthestIsNotSeen) {
  CameraModel camera = Eye();
  camera.near_m = 1;
  camera.far_m = 3;
  const auto frame = SampleWorld()
                         .Robot(At(0, 0), Seer(camera))
                         .Object(Box{{0.1, 0.1, 0.1}}, Stands(0.8, 0, 0.4))
                         .Object(Box{{0.1, 0.1, 0.1}}, Stands(2.0, 0.5, 0.4))
                         .Object(Box{{0.1, 4, 4}}, Stands(5, 0, 1))
                         .MakeFrame();
  const std::string& legend = Look(*frame, ImageFormat::kSegmentation).legend;
  EXPECT_THAT(legend, HasSubstr("3="));
  EXPECT_EQ(legend.find("2="), std::string::npos);
  EXPECT_EQ(legend.find("4="), std::string::npos);
}

TEST(RobotCameraTest, ATurnedCameraSeesTheWorldTurned) {
  CameraModel camera = Eye();
  camera.mount.X_LS.q = FromRollPitchYaw(M_PI / 2, 0, 0);  // its left is up
  const auto frame = SampleWorld()
                         .Robot(At(0, 0), Seer(camera))
                         .Object(Box{{0.1, 0.1, 0.1}}, Stands(2.0, 0, 0.8))
                         .MakeFrame();
  const auto numbers = Values<std::uint16_t>(Look(*frame, ImageFormat::kSegmentation));
  const Vector3 at = Project(*frame, {1.95, 0, 0.8});
  EXPECT_LT(at.x(), 110);
  EXPECT_EQ(numbers[static_cast<std::size_t>(static_cast<int>(at.y()) * 320 + static_cast<int>(at.x()))], 2);
}

/// A scene with things of every kind.
std::shared_ptr<Frame> Busy(const CameraModel& camera) {
  SampleWorld world;
  world.Robot(At(0, 0), Seer(camera)).Robot(At(2, 0.5, 1)).Robot(At(4, -1, 2));
  world.Object(Box{{0.4, 0.8, 0.6}}, {{2.2, -0.7, 0.3}, FromRollPitchYaw(0, 0, 0.3)});
  world.Object(Cylinder{0.2, 0.5}, Stands(1.5, 0.6, 0.25)).Object(Sphere{0.2}, Stands(3, 0.1, 0.2));
  return world.MakeFrame();
}

constexpr ImageFormat kFormats[] = {ImageFormat::kRgb, ImageFormat::kJpeg, ImageFormat::kDepth,
                                    ImageFormat::kSegmentation};

TEST(RobotCameraTest, BothSurfacesDrawTheSameBytes) {
  const auto frame = Busy(Eye());
  for (const ImageFormat format : kFormats) {
    EXPECT_EQ(*Look(*frame, format, RendererKind::kOsmesa).bytes,
              *Look(*frame, format, RendererKind::kEgl).bytes)
        << static_cast<int>(format);
  }
}

TEST(RobotCameraTest, WhatARecordingHoldsLooksTheSame) {
  const auto frame = Busy(Eye());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> little(-1e-4, 1e-4);
  for (int i = 0; i < 5; ++i) {
    for (BodyState& body : frame->bodies) {
      for (double& x : body.p_WB) x += little(random);
    }
    const FramePtr recorded = AsRecorded(*frame);
    for (const ImageFormat format : kFormats)
      EXPECT_EQ(*Look(*frame, format).bytes, *Look(*recorded, format).bytes);
  }
}

TEST(RobotCameraTest, RoundingTwiceIsRoundingOnce) {
  const auto frame = Busy(Eye());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < 200; ++i) {
    for (BodyState& body : frame->bodies) {
      for (double& x : body.p_WB) x = 30 * any(random);
      Eigen::Vector4d q(any(random), any(random), any(random), any(random));
      q.normalize();
      std::copy_n(q.data(), 4, body.q_WB.begin());
    }
    const FramePtr once = AsRecorded(*frame), twice = AsRecorded(*once);
    for (std::size_t k = 0; k < frame->bodies.size(); ++k) {
      EXPECT_EQ(once->bodies[k].p_WB, twice->bodies[k].p_WB);
      EXPECT_EQ(once->bodies[k].q_WB, twice->bodies[k].q_WB);
    }
  }
}

// --- colours

/// The formula of docs/physics.md for a horizontal plane of this grey, high above the floor, seen from above.
double LevelPlane(double grey, const Vector3& lamps) {
  const Vector3 sun = SunDirection().normalized(), up = Vector3::UnitZ();
  const double cosine = sun.z(), half = up.dot((up + sun).normalized());
  const double light = 0.40 + 0.80 * cosine + lamps.x();  // the red component
  return 255 * std::sqrt(grey * grey * light + 0.22 * cosine * std::pow(half, 36));
}

std::shared_ptr<Frame> Table(const std::vector<PointLight>& lights, const Texture& texture = {}) {
  CameraModel camera = Eye(64, 64);
  camera.mount.X_LS = {{0, 0, 2}, FromRollPitchYaw(0, M_PI / 2, 0)};  // it looks down
  std::shared_ptr<Frame> frame =
      SampleWorld().Robot(At(0, 0), Seer(camera)).Object(Box{{1, 1, 0.1}}, Stands(0, 0, 0.95)).MakeFrame();
  auto scenario = std::make_shared<Scenario>(*frame->scene->scenario);
  scenario->lights = lights;
  scenario->objects[0].color = {0.5, 0.5, 0.5};
  scenario->objects[0].texture = texture;
  frame->scene = MakeScene(scenario);
  return frame;
}

TEST(RobotCameraTest, APlanesColourIsThatOfTheFormula) {
  const auto rgb = Values<std::uint8_t>(Look(*Table({}), ImageFormat::kRgb));
  EXPECT_NEAR(rgb[3 * (32 * 64 + 32)], LevelPlane(0.5, Vector3::Zero()), 1);
}

TEST(RobotCameraTest, ALampGivesPowerByTheSquareOfItsDistance) {
  PointLight lamp;
  lamp.p_WP = {0, 0, 1.5};  // half a metre above
  lamp.power = 0.1;
  lamp.color = {0.5, 1, 1};
  const auto rgb = Values<std::uint8_t>(Look(*Table({lamp}), ImageFormat::kRgb));
  EXPECT_NEAR(rgb[3 * (32 * 64 + 32)], LevelPlane(0.5, {0.5 * 0.1 / 0.25, 0, 0}), 1);
}

TEST(RobotCameraTest, ATextureLiesOnABoxFromTheMiddleOfItsSide) {
  // Four fields: red, green / blue, white, row by row from the top, each a quarter of a metre.
  auto image = std::make_shared<Image>();
  image->width = image->height = 2;
  image->rgb = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
  const auto rgb = Values<std::uint8_t>(Look(*Table({}, {image, 0.5, 0.5}), ImageFormat::kRgb));
  // The box's x is up in this picture, its y to the left: the texture's right is up, its top is left.
  const double pixels_per_m = Eye(64, 64).focal_px();
  const auto at = [&](double x_m, double y_m) {
    const auto column = static_cast<std::size_t>(32 - y_m * pixels_per_m);
    const auto row = static_cast<std::size_t>(32 - x_m * pixels_per_m);
    const std::uint8_t* p = &rgb[3 * (row * 64 + column)];
    return Vector3(p[0] > 128, p[1] > 128, p[2] > 128);
  };
  EXPECT_EQ(at(-0.12, 0.12), Vector3(1, 0, 0));
  EXPECT_EQ(at(0.12, 0.12), Vector3(0, 1, 0));
  EXPECT_EQ(at(-0.12, -0.12), Vector3(0, 0, 1));
  EXPECT_EQ(at(0.12, -0.12), Vector3(1, 1, 1));
}

// --- noise

TEST(RobotCameraTest, NoiseOfThePixelsHasItsMeanAndDeviation) {
  CameraModel noisy = Eye();
  noisy.noise.stddev = 0.04;
  const auto clean = Values<std::uint8_t>(Look(*Busy(Eye()), ImageFormat::kRgb));
  const auto frame = Busy(noisy);
  const auto seen = Values<std::uint8_t>(Look(*frame, ImageFormat::kRgb));
  double sum = 0, squares = 0;
  int count = 0;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    if (clean[i] < 60 || clean[i] > 190) continue;  // without clipping
    const double difference = static_cast<double>(seen[i]) - clean[i];
    sum += difference;
    squares += difference * difference;
    ++count;
  }
  ASSERT_GT(count, 20000);
  EXPECT_NEAR(sum / count, 0, 0.3);
  EXPECT_NEAR(std::sqrt(squares / count), 0.04 * 255, 0.02 * 0.04 * 255 + 0.1);
}

TEST(RobotCameraTest, NoiseIsTheSameForAStepAndAnotherForTheNext) {
  CameraModel noisy = Eye();
  noisy.noise.stddev = 0.04;
  const auto frame = Busy(noisy);
  const auto first = *Look(*frame, ImageFormat::kRgb).bytes;
  EXPECT_EQ(*Look(*frame, ImageFormat::kRgb).bytes, first);
  frame->step += 1;
  EXPECT_NE(*Look(*frame, ImageFormat::kRgb).bytes, first);
}

TEST(RobotCameraTest, DepthNoiseLeavesNothingAsNothing) {
  CameraModel noisy = Eye();
  noisy.depth_noise.stddev = 0.01;
  const auto clean = Values<float>(Look(*Busy(Eye()), ImageFormat::kDepth));
  const auto seen = Values<float>(Look(*Busy(noisy), ImageFormat::kDepth));
  double squares = 0;
  int count = 0;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    EXPECT_EQ(std::isinf(clean[i]), std::isinf(seen[i]));
    if (std::isinf(clean[i])) continue;
    squares += std::pow(static_cast<double>(seen[i] - clean[i]), 2);
    ++count;
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.01, 3e-4);
}

// --- sizes and wrong requests

TEST(RobotCameraTest, TheSmallestAndALargePictureAreDrawn) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(7, 3), std::pair(2048, 1024)}) {
    const ImageResult result = Look(*Busy(Eye(width, height)), ImageFormat::kRgb);
    EXPECT_EQ(result.width, width);
    EXPECT_EQ(result.height, height);
    EXPECT_EQ(result.bytes->size(), static_cast<std::size_t>(3 * width * height));
  }
}

TEST(RobotCameraTest, ACameraThatIsNotThereIsToldInWords) {
  const auto frame = Busy(Eye());
  PictureMaker maker(RendererKind::kOsmesa);
  ImageRequest request;
  request.shot = CameraShot{nullptr, 0, 0};
  EXPECT_THAT(maker.Make(*frame, request).error, HasSubstr("no such camera"));
  request.shot = CameraShot{nullptr, 17, 0};
  EXPECT_THAT(maker.Make(*frame, request).error, HasSubstr("no longer part"));
}

TEST(RobotCameraTest, OnlyCamerasOfRobotsSeeDepth) {
  ImageRequest request;
  request.format = ImageFormat::kDepth;
  EXPECT_THAT(CheckImageRequest(request), HasSubstr("name a camera"));
}

TEST(RobotCameraTest, PicturesForPeopleShowDepthsAndNumbers) {
  const auto frame = Busy(Eye());
  for (const ShotView view : {ShotView::kDepth, ShotView::kSegmentation}) {
    ImageRequest request;
    request.format = ImageFormat::kPng;
    request.shot = CameraShot{nullptr, 0, SensorOf(*frame), view};
    const ImageResult result = PictureMaker(RendererKind::kOsmesa).Make(*frame, request);
    EXPECT_EQ(result.error, "");
    EXPECT_GT(result.bytes->size(), 200);
  }
}

}  // namespace
}  // namespace coopdyn::robot_camera

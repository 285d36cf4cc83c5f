// SPDX-License-Identifier: MIT
// Marks of sensors in the view: at their readings, only in the view, and only on request.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "server/render/draw_list.h"
#include "server/sensing/readings.h"
#include "server/state/sample_keeper.h"
#include "tests/server/render/shot.h"
#include "tests/server/sensing/sample_frame.h"

namespace coopdyn::sensor_marks {
namespace {

constexpr double kEye_m = 0.5;  // height of the sensors, above the sample robot

Mount OnTop(const Quaternion& q = Quaternion::Identity()) {
  return {0, {{0, 0, kEye_m - 0.05}, q}};
}

LidarModel Fan(int columns, int rows = 1) {
  LidarModel lidar;
  lidar.mount = OnTop();
  lidar.columns = columns;
  lidar.first_azimuth_rad = -0.5;
  lidar.last_azimuth_rad = 0.5;
  lidar.rows = rows;
  lidar.last_elevation_rad = rows > 1 ? 0.3 : 0;
  lidar.max_range_m = 5;
  return lidar;
}

CameraModel Eye() {
  CameraModel camera;
  camera.mount = OnTop();
  camera.width = 160;
  camera.height = 120;
  return camera;
}

/// A robot at the origin that looks along x and has only this sensor.
std::shared_ptr<RobotModel> With(const SensorKind& sensor, const SensorTiming& timing = {}) {
  auto model = SampleRobot();
  model->sensors.clear();
  model->AddSensor("sensor", sensor, timing);
  return model;
}

/// The face of a white wall at x = 2.
SampleWorld BeforeAWall(std::shared_ptr<const RobotModel> model) {
  SampleWorld world;
  world.Robot(At(0, 0), std::move(model))
      .Object(Box{{0.2, 4, 2}}, {{2.1, 0, 1}, Quaternion::Identity()}, 0, {0.9, 0.9, 0.9});
  return world;
}
const Vector3 kHit(2, 0, kEye_m), kBeforeHit(1, 0, kEye_m);

ImageRequest View(bool show_rays) {
  ImageRequest request = PictureFrom({-1.5, -2.5, 2}, {1.5, 0, 0.5});
  request.show_names = false;
  request.show_rays = show_rays;
  return request;
}

/// The change of a point's colour in the view by marks of sensors.
Pixel Change(const Frame& frame, const Vector3& p_W) {
  const Pixel with = Shot(frame, View(true)).At(p_W), without = Shot(frame, View(false)).At(p_W);
  return {with.r - without.r, with.g - without.g, with.b - without.b};
}

void ExpectSame(const Pixel& change) {
  EXPECT_EQ(std::abs(change.r) + std::abs(change.g) + std::abs(change.b), 0)
      << change.r << " " << change.g << " " << change.b;
}

TEST(SensorMarksTest, AScanIsBlueWhereItsRaysEnd) {
  const auto frame = BeforeAWall(With(Fan(101))).MakeFrame();
  const Pixel dot = Shot(*frame, View(true)).At(kHit);
  EXPECT_GT(dot.b, 200);
  EXPECT_LT(dot.r, 60);
  ExpectSame(Change(*frame, kHit + Vector3(0, 0, 0.3)));
}

TEST(SensorMarksTest, TheAreaThatAScanCoversIsTinted) {
  const auto frame = BeforeAWall(With(Fan(101))).MakeFrame();
  const Pixel area = Change(*frame, kBeforeHit);
  EXPECT_LT(area.r, -10);
  EXPECT_GT(area.r, -60);
}

TEST(SensorMarksTest, NothingIsDrawnWhereAScanMeetsNothing) {
  const auto frame = SampleWorld().Robot(At(0, 0), With(Fan(101))).MakeFrame();
  EXPECT_TRUE(MakeDrawList(*frame, View(true), CameraFor(View(true), *frame->scene)).sensor_marks.empty());
}

TEST(SensorMarksTest, FewRaysOfALidarAreLinesToTheirEnds) {
  const auto frame = BeforeAWall(With(Fan(3))).MakeFrame();
  EXPECT_LT(Change(*frame, kBeforeHit).b, -40);  // orange
  const Pixel dot = Shot(*frame, View(true)).At(kHit);
  EXPECT_GT(dot.r, dot.b + 120);
}

TEST(SensorMarksTest, TheRowsOfA3dLidarGoFromBlueToRed) {
  const auto frame = BeforeAWall(With(Fan(41, 5))).MakeFrame();
  const Shot shot(*frame, View(true));
  const Pixel low = shot.At(kHit), high = shot.At(kHit + Vector3(0, 0, 2 * std::tan(0.3)));
  EXPECT_GT(low.b, low.r + 120);
  EXPECT_GT(high.r, high.b + 120);
  ExpectSame(Change(*frame, kBeforeHit));
}

TEST(SensorMarksTest, OfVeryManyPointsAFewAreDrawn) {
  LidarModel lidar = Fan(4000, 60);
  const auto frame = BeforeAWall(With(lidar)).MakeFrame();
  const DrawList list = MakeDrawList(*frame, View(true), CameraFor(View(true), *frame->scene));
  EXPECT_LE(list.sensor_marks.size(), 3U * 30000U);
  EXPECT_GE(list.sensor_marks.size(), 3U * 15000U);
}

TEST(SensorMarksTest, ALidarWithARateShowsItsLastSampleWhereItWasTaken) {
  const auto model = With(Fan(101), {.rate_hz = 5});
  auto before = BeforeAWall(model).MakeFrame();
  auto frame = BeforeAWall(model).MakeFrame();
  ASSERT_EQ(frame->scene->clocks.size(), 1U);
  for (BodyState& body : frame->bodies) body.p_WB.y() += 1.5;
  const Vector3 edge(2, -2 * std::tan(0.5) + 1e-3,
                     kEye_m);  // the robot has turned its last rays away from it
  ExpectSame(Change(*frame, edge));
  before->scene = frame->scene;
  frame->samples = {{SampleKeeper::Copy(*before)}};
  EXPECT_GT(Shot(*frame, View(true)).At(edge).b, 200);
}

TEST(SensorMarksTest, ASonarsConeEndsAtItsRange) {
  SonarModel sonar;
  sonar.beams.push_back({OnTop(), 0.4, 0, 4});
  const auto frame = BeforeAWall(With(sonar)).MakeFrame();
  ASSERT_EQ(SonarRanges(*frame, 0)[0], 2);
  const Pixel cap = Change(*frame, Vector3(2 * std::cos(0.1), 0, kEye_m + 2 * std::sin(0.1)));
  EXPECT_LT(cap.b, -60);                                         // one of its arcs
  EXPECT_LT(Change(*frame, Vector3(1.2, -0.1, kEye_m)).b, -20);  // the arc is filled
  ExpectSame(Change(*frame, Vector3(1.2, -0.6, kEye_m)));
}

TEST(SensorMarksTest, AnInfraredRayEndsAtWhatItMeets) {
  InfraredModel infrared;
  infrared.eyes = {OnTop()};
  infrared.curve = {{0.1, 3, 0}, {0.8, 0.4, 0}};
  infrared.max_range_m = 3;
  const auto frame = BeforeAWall(With(infrared)).MakeFrame();
  EXPECT_LT(Change(*frame, kBeforeHit).b, -40);
  const Pixel dot = Shot(*frame, View(true)).At(kHit);
  EXPECT_GT(dot.r, dot.b + 120);
}

TEST(SensorMarksTest, ACameraHasTheOutlineOfItsView) {
  const auto frame = SampleWorld().Robot(At(0, 0), With(Eye())).MakeFrame();
  const CameraModel& camera = *ModelOf(*frame, 0).Find<CameraModel>();
  const double left = camera.width / 2.0 / camera.focal_px(), up = camera.height / 2.0 / camera.focal_px();
  const Pixel edge = Change(*frame, Vector3(0, 0, kEye_m) + 0.3 * Vector3(1, -left, -up));
  EXPECT_LT(edge.brightness(), -150);
}

TEST(SensorMarksTest, ARobotsOwnCameraNeverShowsThem) {
  auto model = With(Fan(101));
  model->AddSensor("eye", Eye());
  SonarModel sonar;
  sonar.beams.push_back({OnTop(), 0.4, 0, 4});
  model->AddSensor("sonar", sonar);
  const auto frame = BeforeAWall(model).Robot(At(1, 0.5), SampleRobot()).MakeFrame();
  for (const ImageFormat format : {ImageFormat::kRgb, ImageFormat::kDepth, ImageFormat::kSegmentation}) {
    PictureMaker maker(RendererKind::kOsmesa);
    ImageRequest request;
    request.format = format;
    request.shot = CameraShot{nullptr, 0, ModelOf(*frame, 0).IndexOf<CameraModel>()};
    const ImageResult without = maker.Make(*frame, request);
    request.show_rays = true;
    const ImageResult with = maker.Make(*frame, request);
    ASSERT_TRUE(without.bytes && with.bytes) << with.error;
    EXPECT_EQ(maker.drawn(), 2);
    EXPECT_EQ(*with.bytes, *without.bytes) << static_cast<int>(format);
  }
}

TEST(SensorMarksTest, APictureWithoutThemReadsNoSensor) {
  const auto frame = BeforeAWall(With(Fan(101))).MakeFrame();
  MakeDrawList(*frame, View(false), CameraFor(View(false), *frame->scene));
  EXPECT_EQ(frame->cache, nullptr);
  MakeDrawList(*frame, View(true), CameraFor(View(true), *frame->scene));
  EXPECT_NE(frame->cache, nullptr);
}

TEST(SensorMarksTest, WhatIsOutOfThePictureIsNotRead) {
  const auto frame = BeforeAWall(With(Fan(101))).MakeFrame();
  ImageRequest request = PictureFrom({-8, 0, 1}, {-12, 0, 1});
  request.show_rays = true;
  EXPECT_TRUE(MakeDrawList(*frame, request, CameraFor(request, *frame->scene)).sensor_marks.empty());
  EXPECT_EQ(frame->cache, nullptr);
}

TEST(SensorMarksTest, DrawingChangesNoReading) {
  LidarModel noisy = Fan(101);
  noisy.noise.stddev = 0.05;
  const auto drawn = BeforeAWall(With(noisy)).MakeFrame(), not_drawn = BeforeAWall(With(noisy)).MakeFrame();
  MakeDrawList(*drawn, View(true), CameraFor(View(true), *drawn->scene));
  const auto scan = Scan(*drawn, 0), expected = Scan(*not_drawn, 0);
  EXPECT_TRUE(std::ranges::equal(scan, expected));
  const std::vector<RaySegment> rays = ScanRays(*drawn, 0);
  for (std::size_t k = 0; k < scan.size(); ++k)
    EXPECT_NEAR((rays[k].to_W - rays[k].from_W).norm(), scan[k], 1e-12);
}

}  // namespace
}  // namespace coopdyn::sensor_marks

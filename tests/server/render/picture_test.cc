// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <unistd.h>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/geometry/mesh.h"
#include "tests/server/render/decode.h"
#include "tests/server/render/shot.h"
#include "tests/server/sensing/sample_frame.h"

namespace coopdyn {
namespace {

const ImageRequest kFromAbove = PictureFrom({0, 0, 8}, {0, 0, 0});

TEST(PictureTest, ARobotIsSeenInItsColourWhereItStands) {
  auto frame = SampleWorld().Robot(At(1, 1), SampleRobot(), {0.1, 0.2, 0.9}).MakeFrame();
  ImageRequest request = kFromAbove;
  request.show_names = false;
  const Vector3 top(0.92, 1, kSampleHeight_m);  // behind its heading mark
  const Pixel robot = Shot(*frame, request).At(top);
  EXPECT_GT(robot.b, robot.r + 80);
  EXPECT_GT(robot.b, robot.g + 60);
  for (BodyState& body : frame->bodies) body.p_WB.x() -= 2;
  const Pixel floor = Shot(*frame, request).At(top);
  EXPECT_NEAR(floor.b, floor.r, 25);  // the robot has moved away
}

TEST(PictureTest, TheHeadingMarkIsAhead) {
  const auto frame = SampleWorld().Robot(At(0, 0, 1.57)).MakeFrame();
  ImageRequest request = kFromAbove;
  request.show_names = false;
  const Shot shot(*frame, request);
  EXPECT_GT(shot.At(Vector3(0, 0.07, kSampleHeight_m)).brightness(),
            shot.At(Vector3(0, -0.07, kSampleHeight_m)).brightness() + 150);
}

/// A robot that is a horizontal square of 1 m, with the texture `image`.
std::shared_ptr<const RobotModel> Carpet(std::shared_ptr<const Image> image) {
  Vector3 middle = Vector3::Zero();
  auto data = std::make_shared<MeshData>(
      MakeMesh({{-0.5, -0.5, 0.1}, {0.5, -0.5, 0.1}, {0.5, 0.5, 0.1}, {-0.5, 0.5, 0.1}},
               {{0, 1, 2}, {0, 2, 3}}, middle));
  auto skin = std::make_shared<MeshSkin>();
  skin->corners = {{{0, 0}, 0}, {{1, 0}, 0}, {{1, 1}, 0}, {{0, 1}, 0}};
  skin->materials.push_back({{0.5, 0.5, 0.5}, {1, 1, 1}, std::move(image)});
  data->skin = std::move(skin);
  data->color = {0.5, 0.5, 0.5};
  auto model = std::make_shared<RobotModel>(*SampleRobot());
  LinkShape visual{Mesh{data.get()}, {{0, 0, 0.1}, Quaternion::Identity()}, {0.5, 0.5, 0.5}};
  model->links[0].visuals = {visual};
  model->meshes.push_back(std::move(data));
  return model;
}

TEST(PictureTest, ATextureLiesOnItsMeshTheRightWayUp) {
  auto image = std::make_shared<Image>();
  image->width = image->height = 2;
  image->rgb = {200, 0, 0, 0, 200, 0, 0, 0, 200, 200, 200, 200};  // red, green; below them blue, grey
  const auto frame = SampleWorld().Robot(At(0, 0), Carpet(std::move(image))).MakeFrame();
  ImageRequest request = kFromAbove;
  request.show_names = false;
  const Shot shot(*frame, request);
  const Pixel red = shot.At(Vector3(-0.25, 0.25, 0.1)), green = shot.At(Vector3(0.25, 0.25, 0.1)),
              blue = shot.At(Vector3(-0.25, -0.25, 0.1));
  EXPECT_GT(red.r, red.g + 80);
  EXPECT_GT(green.g, green.r + 80);
  EXPECT_GT(blue.b, blue.r + 80);
}

TEST(PictureTest, ATargetIsMarkedOnTheFloorInItsColour) {
  const auto frame = SampleWorld().Mark(-1, 0.5, 0, {0, 0.8, 0}).MakeFrame();
  const Pixel ring = Shot(*frame, kFromAbove).At(Vector3(-1.2, 0.5, 0));
  EXPECT_GT(ring.g, ring.r + 60);
  EXPECT_GT(ring.g, ring.b + 60);
}

TEST(PictureTest, TheFloorHasALineEveryMetre) {
  const auto frame = SampleWorld().Floor(10, 10).MakeFrame();
  ImageRequest request = PictureFrom({0.5, 0.5, 2}, {0.5, 0.5, 0});
  request.width = request.height = 480;
  const Shot shot(*frame, request);
  const int cell = shot.At(Vector3(0.5, 0.5, 0)).brightness();
  EXPECT_LT(shot.At(Vector3(0, 0.5, 0)).brightness(), cell - 40);
  EXPECT_LT(shot.At(Vector3(0.5, 1, 0)).brightness(), cell - 40);
  EXPECT_NEAR(shot.At(Vector3(0.25, 0.7, 0)).brightness(), cell, 6);
}

TEST(PictureTest, BeyondTheFloorIsTheBackground) {
  SampleWorld red_floor;
  red_floor.Floor(2, 2);
  const auto frame = red_floor.MakeFrame();
  auto scene = std::make_shared<Scene>(*frame->scene);
  scene->floor.color = {0.9, 0.1, 0.1};
  frame->scene = scene;
  const Shot shot(*frame, kFromAbove);
  EXPECT_GT(shot.At(Vector3(0.5, 0.5, 0)).r, shot.At(Vector3(0.5, 0.5, 0)).b + 80);
  const Pixel beyond = shot.At(5, 5);
  EXPECT_GT(beyond.b, 120);
  EXPECT_GE(beyond.b, beyond.r);
}

TEST(PictureTest, ThingsThrowShadowsThatDoNotAddUp) {
  SampleWorld world;
  world.Object(Box{{0.4, 0.4, 1}}, {{0.5, 0.5, 0.5}, Quaternion::Identity()});
  const Vector3 in_shadow(0.9, 1.0, 0);  // the sun stands at −x −y
  const int lit = Shot(*SampleWorld().MakeFrame(), kFromAbove).At(in_shadow).brightness();
  const int once = Shot(*world.MakeFrame(), kFromAbove).At(in_shadow).brightness();
  EXPECT_LT(once, lit - 60);
  world.Object(Box{{0.4, 0.4, 0.95}}, {{0.5, 0.5, 0.475}, Quaternion::Identity()});
  EXPECT_NEAR(Shot(*world.MakeFrame(), kFromAbove).At(in_shadow).brightness(), once, 3);
}

TEST(PictureTest, SidesTowardsTheSunAreBrighter) {
  const auto frame = SampleWorld().Object(Box{{1, 1, 1}}, {{0, 0, 0.5}, Quaternion::Identity()}).MakeFrame();
  const Shot sunny(*frame, PictureFrom({0, -4, 0.5}, {0, 0, 0.5}));
  const Shot shady(*frame, PictureFrom({0, 4, 0.5}, {0, 0, 0.5}));
  EXPECT_GT(sunny.At(Vector3(0, -0.5, 0.6)).brightness(), shady.At(Vector3(0, 0.5, 0.6)).brightness() + 60);
}

TEST(PictureTest, RaysAreDrawnOnRequest) {
  const auto frame = SampleWorld()
                         .Robot(At(0, 0))
                         .Object(Box{{0.2, 2, 1}}, {{2.1, 0, 0.5}, Quaternion::Identity()})
                         .MakeFrame();
  ImageRequest request = kFromAbove;
  const Vector3 on_ray(1, 0, kSampleSensor_m);
  const Pixel without = Shot(*frame, request).At(on_ray);
  request.show_rays = true;
  const Pixel with = Shot(*frame, request).At(on_ray);
  EXPECT_LT(with.b, without.b - 50);  // orange: a hit
}

TEST(PictureTest, NamesAreWrittenAboveRobots) {
  const auto frame = SampleWorld().Robot(At(0, 0)).MakeFrame();
  ImageRequest request = PictureFrom({-3, 0, 1}, {0, 0, 0.3});
  const Picture named = Shot(*frame, request).picture();
  request.show_names = false;
  const Picture bare = Shot(*frame, request).picture();
  int changed = 0, bright = 0;
  for (std::size_t i = 0; i < named.rgb.size(); i += 3) {
    if (named.rgb[i] == bare.rgb[i]) continue;
    ++changed;
    bright += named.rgb[i] > 170;
  }
  EXPECT_GT(changed, 200);  // the plate
  EXPECT_GT(bright, 20);    // the letters
}

TEST(PictureTest, BothBackEndsGiveNearlyTheSamePicture) {
  const auto frame = SampleWorld()
                         .Robot(At(0, 0))
                         .Mark(1, 1)
                         .Object(Sphere{0.4}, {{-1, 0.5, 0.4}, Quaternion::Identity()})
                         .Object(Box{{0.5, 0.5, 0.5}}, {{1, -1, 0.25}, Quaternion::Identity()})
                         .MakeFrame();
  const ImageRequest request = PictureFrom({-3, -3, 3}, {0, 0, 0});
  const Picture a = Shot(*frame, request, RendererKind::kOsmesa).picture();
  const Picture b = Shot(*frame, request, RendererKind::kEgl).picture();
  ASSERT_EQ(a.rgb.size(), b.rgb.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(a.rgb[i] - b.rgb[i]);
  EXPECT_LT(sum / static_cast<double>(a.rgb.size()), 2.0);
}

TEST(PictureTest, TheSmallestAndTheLargestPicture) {
  const auto frame = SampleWorld().Robot(At(0, 0)).MakeFrame();
  PictureMaker maker(RendererKind::kAuto);
  ImageRequest request;
  request.format = ImageFormat::kRgb;
  request.width = request.height = kMinImagePixels;
  EXPECT_EQ(maker.Make(*frame, request).bytes->size(), 3U * kMinImagePixels * kMinImagePixels);
  request.width = kMaxImageWidth;
  request.height = kMaxImageHeight;
  EXPECT_EQ(maker.Make(*frame, request).bytes->size(), 3U * kMaxImageWidth * kMaxImageHeight);
  request.width = kMaxImageWidth + 1;
  EXPECT_NE(maker.Make(*frame, request).error, "");
}

TEST(PictureMakerTest, NobodyAsksNoContext) {
  const PictureMaker maker(RendererKind::kAuto);
  EXPECT_FALSE(maker.has_context());
  EXPECT_EQ(maker.description(), "");
}

TEST(PictureMakerTest, TheSamePictureOfTheSameFrameIsDrawnOnce) {
  auto frame = SampleWorld().Robot(At(0, 0)).MakeFrame();
  PictureMaker maker(RendererKind::kAuto);
  ImageRequest request;
  request.width = request.height = 64;
  const ImageResult first = maker.Make(*frame, request);
  request.paced = true;
  EXPECT_EQ(maker.Make(*frame, request).bytes, first.bytes);
  EXPECT_EQ(maker.drawn(), 1);
  request.show_rays = true;
  maker.Make(*frame, request);
  EXPECT_EQ(maker.drawn(), 2);
  frame->revision++;
  maker.Make(*frame, request);
  EXPECT_EQ(maker.drawn(), 3);
}

TEST(PictureMakerTest, TheResultNamesItsFrameAndCamera) {
  auto frame = SampleWorld().Robot(At(0, 0)).MakeFrame();
  frame->time = 1'000'000'000;
  const ImageResult result = PictureMaker(RendererKind::kAuto).Make(*frame, kFromAbove);
  EXPECT_EQ(result.step, frame->step);
  EXPECT_EQ(result.time, frame->time);
  EXPECT_EQ(result.camera.eye_m, Vector3(0, 0, 8));
  EXPECT_EQ(DecodePng(*result.bytes).width, 320);
}

TEST(PictureMakerTest, WithoutGlARequestFailsWithAClearText) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto attempt = [] {
    setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere.json", 1);
    const auto frame = SampleWorld().MakeFrame();
    PictureMaker maker(RendererKind::kEgl);
    const std::string error = maker.Make(*frame, {}).error;
    std::fprintf(stderr, "%s\n", error.c_str());
    std::_Exit(maker.Make(*frame, {}).error == error && !error.empty() ? 0 : 1);
  };
  EXPECT_EXIT(attempt(), testing::ExitedWithCode(0), "no pictures: EGL cannot make .* use --renderer osmesa");
}

TEST(GlContextTest, RenderersHaveNames) {
  EXPECT_EQ(ParseRenderer("osmesa"), RendererKind::kOsmesa);
  EXPECT_EQ(ParseRenderer("egl"), RendererKind::kEgl);
  EXPECT_EQ(ParseRenderer("auto"), RendererKind::kAuto);
  EXPECT_FALSE(ParseRenderer("opengl"));
}

TEST(GlContextTest, AMissingLibraryIsNamed) {
  std::string error;
  EXPECT_EQ(OpenLibrary({"libnothing-of-this-name.so.1"}, error), nullptr);
  EXPECT_NE(error.find("libnothing-of-this-name.so.1"), std::string::npos);
}

class RenderPictureTest : public testing::Test {
 protected:
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("coopdyn_picture_" + std::to_string(::getpid()));
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static std::vector<std::uint8_t> ReadAll(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
};

TEST_F(RenderPictureTest, WritesPngAndJpegFiles) {
  const auto frame = SampleWorld().Robot(At(0, 0)).MakeFrame();
  EXPECT_EQ(RenderPicture(*frame, {}, RendererKind::kAuto, folder_ / "a.png"), std::nullopt);
  EXPECT_EQ(DecodePng(ReadAll(folder_ / "a.png")).width, 640);
  EXPECT_EQ(RenderPicture(*frame, {}, RendererKind::kAuto, folder_ / "a.jpg"), std::nullopt);
  EXPECT_EQ(DecodeJpeg(ReadAll(folder_ / "a.jpg")).height, 480);
}

TEST_F(RenderPictureTest, SaysWhatIsWrongWithTheFile) {
  const auto frame = SampleWorld().MakeFrame();
  const auto ending = RenderPicture(*frame, {}, RendererKind::kAuto, "a.bmp");
  ASSERT_TRUE(ending);
  EXPECT_EQ(*ending, "a.bmp: write a file name that ends in .png or .jpg");
  const auto missing = RenderPicture(*frame, {}, RendererKind::kAuto, folder_ / "none" / "a.png");
  ASSERT_TRUE(missing);
  EXPECT_NE(missing->find("No such file"), std::string::npos);
}

}  // namespace
}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/replay/export_pictures.h"

#include <gmock/gmock.h>

#include <cmath>

#include "export_fixture.h"
#include "server/replay/ffmpeg.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ExportPicturesTest : public ExportTest {
 protected:
  /// Options of small pictures from near by.
  static PictureOptions Near() {
    PictureOptions options;
    options.image.width = 64;
    options.image.height = 48;
    options.image.eye_m = Vector3(0.2, -0.6, 0.6);
    options.image.look_m = Vector3(0.1, 0, 0);
    options.fps = 10;
    return options;
  }
  std::vector<std::string> Pictures() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(File("run-png")))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }
  /// Width and height of a PNG file.
  static std::array<int, 2> Size(const std::string& png) {
    const auto number = [&](std::size_t at) {
      int value = 0;
      for (std::size_t i = 0; i < 4; ++i) value = value * 256 + static_cast<unsigned char>(png.at(at + i));
      return value;
    };
    return {number(16), number(20)};
  }
  std::string Export(const ExportOptions& options = {}, const ExportProgress& progress = nullptr) {
    return ExportPictures(*Open(), options, Near(), File("run-png"), progress);
  }
};

TEST_F(ExportPicturesTest, AreNumberedFromTheFirstMomentToTheLast) {
  Record();
  ASSERT_EQ(Export(), "");
  EXPECT_THAT(Pictures(), ElementsAre("000001.png", "000002.png", "000003.png", "000004.png", "000005.png"));
  EXPECT_THAT(Files(), ElementsAre("run-png", "run.run"));
  const std::string first = Text(File("run-png/000001.png"));
  EXPECT_EQ(Size(first), (std::array{64, 48}));
  EXPECT_NE(first, Text(File("run-png/000005.png"))) << "the robot drove";
}

TEST_F(ExportPicturesTest, OnePictureIsThatOfTheFilmAtItsTime) {
  Record();
  ASSERT_EQ(Export(), "");
  ASSERT_EQ(ExportPicture(*Open(), 0.3, Near(), File("one.png"), false), "");
  EXPECT_EQ(Text(File("one.png")), Text(File("run-png/000004.png")));
  EXPECT_NE(Text(File("one.png")), Text(File("run-png/000001.png")));
}

TEST_F(ExportPicturesTest, BetweenRecordedPosesTheLastOnesAreShown) {
  Record({.pose_every = 200'000'000});
  ASSERT_EQ(Export(), "");
  EXPECT_EQ(Text(File("run-png/000001.png")), Text(File("run-png/000002.png")));
  EXPECT_NE(Text(File("run-png/000001.png")), Text(File("run-png/000003.png")));
}

TEST_F(ExportPicturesTest, AMomentOutsideTheRunIsAnError) {
  Record({.steps = 2});
  EXPECT_EQ(ExportPicture(*Open(), 9, Near(), File("one.png"), false),
            "--time 9: the run lasts from 0 to 0.02 s");
  EXPECT_EQ(Export({.from_s = 3}), "the run lasts from 0 to 0.02 s: choose --from and --until in between");
  EXPECT_THAT(Files(), ElementsAre("run.run"));
}

TEST_F(ExportPicturesTest, AFolderIsOverwrittenOnlyWhenAskedAndOnlyIfItHoldsPictures) {
  Record({.steps = 2});
  ASSERT_EQ(Export(), "");
  EXPECT_THAT(Export(), HasSubstr("run-png is there already: --force overwrites it"));
  Put("run-png/000777.png", "of a longer run");
  EXPECT_EQ(Export({.overwrite = true}), "");
  EXPECT_THAT(Pictures(), ElementsAre("000001.png"));
  Put("run-png/thesis.tex", "mine");
  EXPECT_THAT(Export({.overwrite = true}), HasSubstr("run-png holds more than pictures (thesis.tex)"));
  EXPECT_EQ(Text(File("run-png/thesis.tex")), "mine");
}

TEST_F(ExportPicturesTest, AnEmptyFolderIsFilledUnasked) {
  Record({.steps = 2});
  std::filesystem::create_directory(File("run-png"));
  ASSERT_EQ(Export(), "");
  EXPECT_THAT(Pictures(), ElementsAre("000001.png"));
}

TEST_F(ExportPicturesTest, StoppedTheyLeaveNothing) {
  Record();
  EXPECT_EQ(Export({}, [](double share) { return share < 0.5; }), kExportStopped);
  EXPECT_THAT(Files(), ElementsAre("run.run"));
}

TEST_F(ExportPicturesTest, AFilmOfOddSizeIsRefused) {
  Record({.steps = 2});
  PictureOptions options = Near();
  options.image.width = 65;
  EXPECT_EQ(ExportVideo(*Open(), {}, options, File("run.mp4"), nullptr),
            "--size: the width and the height of a film are even, e.g. 640x480");
  EXPECT_THAT(Files(), ElementsAre("run.run"));
}

TEST(FilmTimes, StepBySpeedOverPicturesPerSecond) {
  const FilmTimes times{2'000'000'000, 4'000'000'000, 25, 4};
  EXPECT_EQ(times.count(), 13U);  // 2 s at 4 times: half a second of film
  EXPECT_EQ(times.time(0), 2'000'000'000);
  EXPECT_EQ(times.time(1), 2'160'000'000);
  EXPECT_EQ(times.time(12), 3'920'000'000);
  EXPECT_EQ((FilmTimes{0, 1'000'000'000, 25, 1}.count()), 26U);
  EXPECT_EQ((FilmTimes{0, 0, 25, 1}.count()), 1U);
}

TEST(Ffmpeg, IsToldWhatThePixelsAreAndWhatToMakeOfThem) {
  EXPECT_THAT(FfmpegArguments({1280, 720, 29.97}, true, "/a/b.mp4.part"),
              ElementsAre("-hide_banner", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s",
                          "1280x720", "-r", "29.97", "-i", "-", "-an", "-c:v", "libx264", "-pix_fmt",
                          "yuv420p", "-f", "mp4", "-y", "file:/a/b.mp4.part"));
  EXPECT_THAT(FfmpegArguments({640, 480, 1e-2}, false, "x"), testing::Not(testing::Contains("libx264")));
  EXPECT_THAT(FfmpegArguments({640, 480, 1e-2}, false, "x"), testing::Contains("0.01"));
}

}  // namespace
}  // namespace coopdyn

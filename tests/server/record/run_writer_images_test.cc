// SPDX-License-Identifier: MIT
// Pictures in a recording.
#include <gmock/gmock.h>

#include "run_writer_fixture.h"
#include "server/state/sample_keeper.h"

namespace coopdyn {
namespace {

using testing::HasSubstr;

/// A run whose first robot has a camera that takes a picture in every fourth step.
class RecordedImages : public RunWriterTest {
 protected:
  RecordedImages() {
    auto scenario = std::make_shared<Scenario>(*ReadRecordScenario());
    auto model = std::make_shared<RobotModel>(*scenario->robots[0].model);
    model->AddSensor("eye", CameraModel(), {25, 0});
    scenario->robots[0].model = model;
    maker_.SetScene(MakeScene(scenario));
  }

  /// Records `steps` steps with pictures by `draw`.
  void RecordSteps(std::uint64_t steps, DrawImage draw, bool images = true) {
    const SavedStatePtr start = maker_.Start();
    RunWriterOptions options;
    options.header = HeaderOf(*start->frame, start->mode, {.images = images}, 0);
    options.draw = std::move(draw);
    std::string error;
    const auto writer = RunWriter::Create(file_, std::move(options), *start, error);
    ASSERT_NE(writer, nullptr) << error;
    SampleKeeper keeper;
    for (std::uint64_t step = 0; step <= steps; ++step) {
      const auto frame = maker_.Make(step);
      keeper.AddTo(*frame);
      if (step == 0) continue;
      ASSERT_TRUE(writer->AddStep(*frame)) << writer->error();
      ASSERT_TRUE(writer->AddImages(frame)) << writer->error();
    }
    Close(*writer);
  }
};

/// A picture that shows the step's number.
ImageResult DrawStep(const ImageRequest& request) {
  ImageResult result;
  EXPECT_EQ(request.format, ImageFormat::kJpeg);
  result.bytes = std::make_shared<const std::vector<std::uint8_t>>(
      1, static_cast<std::uint8_t>(request.shot->frame->step));
  result.width = 320;
  result.height = 240;
  return result;
}

TEST_F(RecordedImages, EachPictureOfACameraIsThereOnce) {
  RecordSteps(10, DrawStep);
  EXPECT_EQ(AskText(file_, "SELECT group_concat(step) FROM image"), "0,4,8");
  EXPECT_EQ(AskText(file_, "SELECT group_concat(hex(jpeg)) FROM image"), "00,04,08");
  EXPECT_EQ(AskText(file_, "SELECT robot || ' ' || module || ' ' || width FROM image"), "robot1 eye 320");
}

TEST_F(RecordedImages, NobodyDrawsIfTheyAreNotAskedFor) {
  RecordSteps(
      10,
      [](const ImageRequest& request) {
        ADD_FAILURE();
        return DrawStep(request);
      },
      false);
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM image"), 0);
}

TEST_F(RecordedImages, WhyTheyAreMissingIsSaidOnce) {
  RecordSteps(10, [](const ImageRequest&) {
    ImageResult none;
    none.error = "no pictures here";
    return none;
  });
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM event"), 1);
  EXPECT_THAT(AskText(file_, "SELECT text FROM event"),
              HasSubstr("missing from the recording: no pictures here"));
}

}  // namespace
}  // namespace coopdyn

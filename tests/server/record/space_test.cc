// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "record_fixture.h"
#include "server/record/recorder.h"

namespace coopdyn {
namespace {

TEST(SpaceTest, TheEstimateIsThatOfTheFile) {
  FrameMaker maker(RecordScene());
  const SavedStatePtr start = maker.Start();
  TempFolder folder;
  for (const Nanoseconds pose_every : {Nanoseconds{0}, Nanoseconds{50'000'000}}) {
    const RecordWhat what{true, true, true, true};
    const std::string file = folder.File("space" + std::to_string(pose_every) + ".run");
    const auto writer = MakeWriter(file, *start, what, pose_every);
    for (std::uint64_t step = 1; step <= 3000; ++step) {
      const auto frame = maker.Make(step);
      frame->channels = start->frame->channels;
      ASSERT_TRUE(writer->AddStep(*frame));
      if (step % 500 != 0) continue;
      SavedState state;
      state.frame = frame;
      ASSERT_TRUE(writer->AddKeyframe(state));
    }
    std::string remark;
    ASSERT_TRUE(writer->Close(remark));
    const SpaceNeeded space = EstimateSpace(*start->frame, what, pose_every, 30, file);
    const auto bytes = static_cast<double>(std::filesystem::file_size(file));
    EXPECT_NEAR(space.bytes_in_all, bytes, 0.1 * bytes + 200e3);
    EXPECT_DOUBLE_EQ(space.bytes_in_all, 30 * space.bytes_per_s);
    EXPECT_GT(space.bytes_free, 0);
  }
}

TEST(SpaceTest, ARunWithoutEndNeedsNoSum) {
  FrameMaker maker(RecordScene());
  const SpaceNeeded space = EstimateSpace(*maker.Make(0), {}, 0, 0, "here.run");
  EXPECT_EQ(space.bytes_in_all, 0);
  EXPECT_GT(space.bytes_per_s, 0);
}

TEST(SpaceTest, ItIsSaidInTwoFigures) {
  EXPECT_EQ(ToString(SpaceNeeded{2.04e6, 58.3e9, 40e9}),
            "about 2.0 MB per simulated second, 58 GB for this run, 40 GB free");
  EXPECT_EQ(ToString(SpaceNeeded{950, 0, 999.6e9}), "about 950 B per simulated second, 1.0 TB free");
}

}  // namespace
}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/record/space.h"

#include "record_fixture.h"

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

TEST(SpaceTest, PagesSuitTheRows) {
  TempFolder folder;
  std::string error;
  for (const std::size_t row : {60UL, 300UL, 1800UL, 1840UL, 4100UL, 9000UL, 18037UL, 90037UL}) {
    const std::string file = folder.File(std::to_string(row) + ".db");
    const auto database = Database::Open(file, Database::Access::kCreate, error);
    ASSERT_NE(database, nullptr) << error;
    database->Run("PRAGMA page_size = " + std::to_string(PageSizeFor(row)) +
                  "; CREATE TABLE step(step INTEGER PRIMARY KEY, poses BLOB); BEGIN");
    Statement insert = database->Prepare("INSERT INTO step VALUES(?, ?)");
    const std::vector<std::byte> poses(row);
    const auto rows = static_cast<std::int64_t>(10'000'000 / row);
    for (std::int64_t step = 0; step < rows; ++step) insert.Run(step, poses);
    database->Run("COMMIT");
    const auto bytes = static_cast<double>(std::filesystem::file_size(file));
    EXPECT_LE(bytes, 1.1 * static_cast<double>(rows * static_cast<std::int64_t>(row + 8))) << row;
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

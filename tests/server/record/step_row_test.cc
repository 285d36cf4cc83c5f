// SPDX-License-Identifier: MIT
#include "server/record/step_row.h"

#include "record_fixture.h"

namespace coopdyn {
namespace {

TEST(StepRowTest, TheBytesOfARowAreThoseThatAreWritten) {
  FrameMaker maker(RecordScene());
  TempFolder folder;
  const std::string file = folder.File("rows.run");
  const SavedStatePtr start = maker.Start();
  const RecordWhat what{true, true, true, true};
  const auto writer = MakeWriter(file, *start, what);
  constexpr std::uint64_t kSteps = 2000;
  for (std::uint64_t step = 1; step <= kSteps; ++step) {
    const auto frame = maker.Make(step);
    frame->channels = start->frame->channels;  // no commands
    ASSERT_TRUE(writer->AddStep(*frame));
  }
  std::string remark;
  ASSERT_TRUE(writer->Close(remark));
  const std::size_t row = StepRowBytes(*start->frame, what, true);
  const double expected = static_cast<double>(kSteps) * FileBytesPerRow(row, BestPageSize(row));
  const auto page = static_cast<double>(Ask(file, "PRAGMA page_size"));
  EXPECT_EQ(page, static_cast<double>(BestPageSize(row)));
  const double fixed = 40 * page;  // tables with a page each, texts
  EXPECT_NEAR(static_cast<double>(std::filesystem::file_size(file)), expected, 0.03 * expected + fixed);
}

TEST(StepRowTest, PagesSuitTheRows) {
  EXPECT_EQ(BestPageSize(100), 4096U);
  for (const std::size_t row : {60UL, 1800UL, 1840UL, 9000UL, 18037UL, 90037UL}) {
    EXPECT_LE(FileBytesPerRow(row, BestPageSize(row)), 1.08 * static_cast<double>(row)) << row;
  }
}

}  // namespace
}  // namespace coopdyn

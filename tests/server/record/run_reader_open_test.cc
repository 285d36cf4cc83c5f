// SPDX-License-Identifier: MIT
// Files that are being written, files left by a crash, and read-only files.
#include <gtest/gtest.h>
#include <unistd.h>

#include "server/record/run_reader.h"
#include "tests/server/record/run_reader_sample.h"

namespace coopdyn {
namespace {

namespace fs = std::filesystem;

class RunReaderOpenTest : public testing::Test {
 protected:
  void Open(const std::string& file) {
    std::string error;
    reader_ = RunReader::Open(file, error);
    ASSERT_NE(reader_, nullptr) << error;
    reader_->UseScenario(sample_.scenario());
  }
  /// A copy of a recording as a crash would leave it, with its log.
  std::string CrashCopy() {
    const std::string left = folder_.File("left.run");
    const auto writer = sample_.Write(file_, {.close = false});
    fs::copy_file(file_, left);
    fs::copy_file(file_ + "-wal", left + "-wal");
    return left;
  }
  /// After ten polls without news a reader checks whether a writer still exists.
  void LookUntilInDoubt() {
    for (int i = 0; i < 12; ++i) reader_->extent();
  }

  const TempFolder folder_;
  const std::string file_ = folder_.File("lesson1.run");
  const SampleRun sample_;
  std::unique_ptr<RunReader> reader_;
};

TEST_F(RunReaderOpenTest, AClosedFileIsNotTouched) {
  sample_.Write(file_);
  const auto before = fs::last_write_time(file_);
  Open(file_);
  EXPECT_FALSE(reader_->growing());
  EXPECT_TRUE(reader_->Read(20));
  reader_.reset();
  EXPECT_EQ(fs::last_write_time(file_), before);
  EXPECT_FALSE(fs::exists(file_ + "-wal"));
  EXPECT_FALSE(fs::exists(file_ + "-shm"));
  EXPECT_FALSE(fs::exists(file_ + "-journal"));
}

TEST_F(RunReaderOpenTest, AGrowingFileIsFollowed) {
  const auto writer = sample_.Write(file_, {.close = false});
  Open(file_);
  EXPECT_TRUE(reader_->growing());
  EXPECT_FALSE(reader_->mended());
  EXPECT_EQ(reader_->extent().last, 20u);
  sample_.Append(*writer, 21, 40);
  EXPECT_EQ(reader_->extent().last, 40u);
  EXPECT_TRUE(reader_->Read(40));
  EXPECT_EQ(reader_->StepAt(40 * SampleRun::kStep, true), 40u);
  EXPECT_EQ(reader_->Keyframe(40)->frame->step, 40u);
  EXPECT_TRUE(reader_->growing());
}

TEST_F(RunReaderOpenTest, InputsThatCameSinceAreSeen) {
  const auto writer = sample_.Write(file_, {.close = false});
  Open(file_);
  EXPECT_EQ(reader_->Inputs(0, 100).size(), 2u);
  writer->AddInput({20, edit::Pause{}});
  ASSERT_TRUE(writer->Commit());
  EXPECT_EQ(reader_->Inputs(0, 100).size(), 3u);
  EXPECT_EQ(reader_->Inputs(0, 100).size(), 3u);
}

TEST_F(RunReaderOpenTest, ReadingDoesNotDisturbTheWriter) {
  const auto writer = sample_.Write(file_, {.close = false});
  Open(file_);
  for (std::uint64_t step = 21; step < 60; ++step) {
    sample_.Append(*writer, step, step);
    EXPECT_TRUE(reader_->ForEach(0, step, false, [&](const RecordedStep& read) {
      if (read.step == 10) writer->AddEvent({step, 0, "note", "while it is read"});
      return true;
    }));
    EXPECT_TRUE(writer->Commit()) << writer->error();
  }
  EXPECT_EQ(writer->error(), "");
}

TEST_F(RunReaderOpenTest, AClosedRecordingGrowsNoMoreAndBecomesOneFile) {
  auto writer = sample_.Write(file_, {.close = false});
  Open(file_);
  std::string remark;
  ASSERT_TRUE(writer->Close(remark));
  EXPECT_NE(remark, "") << "the reader has it open";
  writer.reset();
  EXPECT_EQ(reader_->extent().last, 20u);
  EXPECT_FALSE(reader_->growing());
  EXPECT_FALSE(reader_->mended());
  EXPECT_TRUE(reader_->Read(20));
  EXPECT_FALSE(fs::exists(file_ + "-wal"));
}

TEST_F(RunReaderOpenTest, AWriterThatIsGoneIsNoticedAndTheFileMended) {
  auto writer = sample_.Write(file_, {.close = false});
  Open(file_);
  LookUntilInDoubt();
  EXPECT_TRUE(reader_->growing()) << "its writer is still there";
  EXPECT_TRUE(reader_->Read(20));
  sample_.Append(*writer, 21, 22);
  EXPECT_EQ(reader_->extent().last, 22u);
  writer.reset();  // without Close(), like a crash
  LookUntilInDoubt();
  EXPECT_FALSE(reader_->growing());
  EXPECT_TRUE(reader_->mended());
  EXPECT_TRUE(reader_->Read(22));
  EXPECT_FALSE(fs::exists(file_ + "-wal"));
}

TEST_F(RunReaderOpenTest, WhatACrashLeftIsMended) {
  const std::string left = CrashCopy();
  ASSERT_GT(fs::file_size(left + "-wal"), 0u);
  Open(left);
  EXPECT_TRUE(reader_->mended());
  EXPECT_FALSE(reader_->growing());
  EXPECT_EQ(reader_->extent().last, 20u);
  EXPECT_FALSE(fs::exists(left + "-wal"));
  Open(left);
  EXPECT_FALSE(reader_->mended()) << "once is enough";
  EXPECT_EQ(reader_->extent().last, 20u);
}

TEST_F(RunReaderOpenTest, LostStepsAreCountedWhenItIsMended) {
  const std::string left = folder_.File("left.run");
  {
    const auto writer = sample_.Write(file_, {.lost_from = 5, .lost_to = 9, .close = false});
    fs::copy_file(file_, left);
    fs::copy_file(file_ + "-wal", left + "-wal");
  }
  Open(left);
  EXPECT_TRUE(reader_->mended());
  EXPECT_EQ(reader_->extent().lost, 5u);
  EXPECT_EQ(reader_->extent().steps, 15u);
}

TEST_F(RunReaderOpenTest, ACutLogIsReadUpToItsLastWholeCommit) {
  const std::string left = CrashCopy();
  const auto size = fs::file_size(left + "-wal");
  for (const std::uintmax_t part : {9, 5, 1}) {
    fs::resize_file(left + "-wal", size * part / 10);
    const std::string copy = folder_.File("cut" + std::to_string(part) + ".run");
    fs::copy_file(left, copy);
    fs::copy_file(left + "-wal", copy + "-wal");
    std::string error;
    const auto reader = RunReader::Open(copy, error);
    EXPECT_TRUE(reader == nullptr || reader->extent().last <= 20) << part;
    EXPECT_EQ(reader == nullptr, !error.empty());
  }
}

TEST_F(RunReaderOpenTest, WhatMayNotBeWrittenToIsReadAsItIs) {
  const std::string left = CrashCopy();
  fs::permissions(left, fs::perms::owner_read);
  Open(left);
  EXPECT_EQ(reader_->extent().last, 20u);
  if (::geteuid() == 0) return;  // root may write to everything
  EXPECT_FALSE(reader_->mended());
}

}  // namespace
}  // namespace coopdyn

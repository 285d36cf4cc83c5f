// SPDX-License-Identifier: MIT
// The run file on disk: concurrent readers, existing files, a full disk.
#include <filesystem>
#include <fstream>

#include "run_writer_fixture.h"

namespace coopdyn {
namespace {

TEST_F(RunWriterTest, ReadersSeeWhatIsCommittedWhileItIsWritten) {
  const auto writer = MakeWriter(file_, *maker_.Start());
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 1);
  ASSERT_TRUE(writer->AddStep(*maker_.Make(1)));
  EXPECT_TRUE(writer->dirty());
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 1);
  ASSERT_TRUE(writer->Commit());
  EXPECT_FALSE(writer->dirty());
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 2);
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'closed'"), 0);
  Close(*writer);
}

TEST_F(RunWriterTest, AFileThatIsOpenElsewhereStaysWholeAndItIsSaid) {
  const auto writer = MakeWriter(file_, *maker_.Start());
  ASSERT_TRUE(writer->AddStep(*maker_.Make(1)));
  std::string error, remark;
  const auto other = Database::Open(file_, Database::Access::kReadOnly, error);
  ASSERT_NE(other, nullptr);
  Statement rows = other->Prepare("SELECT step FROM step");
  ASSERT_TRUE(rows.Step());  // a read is in progress
  EXPECT_TRUE(writer->Close(remark));
  EXPECT_NE(remark.find("is open elsewhere"), std::string::npos) << remark;
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 2);
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'closed'"), 1);
}

TEST_F(RunWriterTest, AnExistingRecordingIsRefused) {
  { const auto old = MakeWriter(file_, *maker_.Start(100)); }
  std::string error;
  EXPECT_EQ(RunWriter::Create(file_, {}, *maker_.Start(), error), nullptr);
  EXPECT_EQ(error, file_ + " exists: choose another name, or --force");
  EXPECT_EQ(Ask(file_, "SELECT step FROM step"), 100);
}

TEST_F(RunWriterTest, WhatIsNoRecordingIsNeverOverwritten) {
  std::ofstream(file_) << "precious";
  for (const bool overwrite : {false, true}) {
    RunWriterOptions options;
    options.overwrite = overwrite;
    std::string error;
    EXPECT_EQ(RunWriter::Create(file_, options, *maker_.Start(), error), nullptr);
    EXPECT_EQ(error, file_ + " is not a recording of coopdyn: choose another name");
    EXPECT_EQ(std::filesystem::file_size(file_), 8U);
  }
}

TEST_F(RunWriterTest, EmptyAndDamagedRecordingsAreOverwritten) {
  std::ofstream(file_).close();
  EXPECT_EQ(WhyNoRunFile(file_, true), "");
  std::filesystem::remove(file_);
  { const auto old = MakeWriter(file_, *maker_.Start()); }
  std::filesystem::resize_file(file_, 100);
  EXPECT_EQ(WhyNoRunFile(file_, true), "");
}

TEST_F(RunWriterTest, AnOverwrittenFileLeavesNothingBehind) {
  std::ofstream(file_).close();
  std::ofstream(file_ + "-wal") << "old";
  std::ofstream(file_ + "-shm") << "old";
  RunWriterOptions options;
  options.overwrite = true;
  std::string error;
  const SavedStatePtr start = maker_.Start();
  options.header = HeaderOf(*start->frame, start->mode, {}, 0);
  const auto writer = RunWriter::Create(file_, options, *start, error);
  ASSERT_NE(writer, nullptr) << error;
  Close(*writer);
  EXPECT_FALSE(std::filesystem::exists(file_ + "-wal"));
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 1);
}

TEST_F(RunWriterTest, AFolderThatIsNotThereIsSaid) {
  std::string error;
  const std::string file = folder_.File("nowhere/test.run");
  EXPECT_EQ(RunWriter::Create(file, {}, *maker_.Start(), error), nullptr);
  EXPECT_EQ(error, "cannot make " + file + ": No such file or directory");
}

TEST_F(RunWriterTest, AFullDiskIsSaidAndWhatWasCommittedIsKept) {
  RunWriterOptions options;
  const SavedStatePtr start = maker_.Start();
  options.header = HeaderOf(*start->frame, start->mode, {}, 0);
  options.page_size = 4096;
  options.max_pages = 60;
  std::string error;
  const auto writer = RunWriter::Create(file_, options, *start, error);
  ASSERT_NE(writer, nullptr) << error;
  std::uint64_t step = 0, committed = 0;
  while (step < 10000 && writer->AddStep(*maker_.Make(++step))) {
    if (step % 50 == 0 && writer->Commit()) committed = step;
  }
  EXPECT_EQ(writer->error(), file_ + ": the disk is full");
  EXPECT_GT(committed, 0U);
  EXPECT_FALSE(writer->AddStep(*maker_.Make(20000)));
  EXPECT_FALSE(writer->Commit());
  EXPECT_EQ(Ask(file_, "SELECT max(step) FROM step"), static_cast<std::int64_t>(committed));
}

TEST_F(RunWriterTest, NoFileIsLeftIfEvenTheFirstFrameFindsNoRoom) {
  RunWriterOptions options;
  options.page_size = 4096;
  options.max_pages = 5;
  std::string error;
  EXPECT_EQ(RunWriter::Create(file_, options, *maker_.Start(), error), nullptr);
  EXPECT_EQ(error, file_ + ": the disk is full");
  EXPECT_FALSE(std::filesystem::exists(file_));
  EXPECT_FALSE(std::filesystem::exists(file_ + "-wal"));
}

}  // namespace
}  // namespace coopdyn

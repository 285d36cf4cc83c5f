// SPDX-License-Identifier: MIT
// A run file written by a test, and its blob columns. One test at a time.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "record_fixture.h"
#include "server/record/run_writer.h"

namespace coopdyn {

/// Opens a file and keeps it open, to read blob columns.
class RunFile {
 public:
  explicit RunFile(const std::string& file) {
    std::string error;
    database_ = Database::Open(file, Database::Access::kReadOnly, error);
    EXPECT_NE(database_, nullptr) << error;
  }
  std::vector<std::byte> Blob(const std::string& sql) {
    Statement row = database_->Prepare(sql);
    if (!row.Step()) return {};
    const auto bytes = row.blob(0);
    return {bytes.begin(), bytes.end()};
  }
  std::vector<CommandRecord> Commands(std::uint64_t step) {
    std::vector<CommandRecord> commands;
    EXPECT_TRUE(
        DecodeCommands(Blob("SELECT commands FROM step WHERE step = " + std::to_string(step)), commands));
    return commands;
  }

 private:
  std::unique_ptr<Database> database_;
};

class RunWriterTest : public testing::Test {
 protected:
  void Close(RunWriter& writer) {
    std::string remark;
    EXPECT_TRUE(writer.Close(remark)) << writer.error();
    EXPECT_EQ(remark, "");
  }
  /// Writes `start`, the frames after it, and the end.
  void Record(const SavedState& start, const std::vector<FramePtr>& frames,
              const RecordWhat& what = {true, true, true, true}) {
    const auto writer = MakeWriter(file_, start, what);
    for (const FramePtr& frame : frames) EXPECT_TRUE(writer->AddStep(*frame)) << writer->error();
    Close(*writer);
  }

  TempFolder folder_;
  const std::string file_ = folder_.File("test.run");
  FrameMaker maker_{RecordScene()};
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Files beside which a kill has left a journal or a log, and files without recorded steps.
#include <gtest/gtest.h>

#include <fstream>

#include "server/record/run_open.h"
#include "server/record/run_reader.h"
#include "tests/server/record/run_reader_sample.h"

namespace coopdyn {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNoStepsText = "nothing was recorded in it";

class RunReaderJournalTest : public testing::Test {
 protected:
  std::unique_ptr<Database> Change(const std::string& file, const std::string& sql) {
    auto database = Database::Open(file, Database::Access::kCreate, error_);
    EXPECT_NE(database, nullptr) << error_;
    EXPECT_TRUE(database->Try(sql)) << database->error();
    return database;
  }
  /// `left`: copy of `file` as a kill during `sql` leaves it: pages are in the file, the journal is complete.
  void KillAmid(const std::string& file, const std::string& sql) {
    const auto database = Change(
        file, "PRAGMA journal_mode = DELETE; PRAGMA cache_size = 1; PRAGMA cache_spill = 1; BEGIN; " + sql);
    fs::copy_file(file, left_);
    fs::copy_file(file + "-journal", left_ + "-journal");
    database->Run("ROLLBACK");
  }
  /// Overwrites many pages; each is spilled because the cache holds one.
  static std::string ManyChanges() {
    return "UPDATE step SET hash = 0, poses = zeroblob(5000); UPDATE meta SET value = 'x';";
  }
  std::string Refusal(const std::string& file) {
    error_.clear();
    EXPECT_EQ(RunReader::Open(file, error_), nullptr);
    return error_;
  }
  void ExpectNoSteps(const std::string& file) {
    const std::string text = Refusal(file);
    EXPECT_NE(text.find(file), std::string::npos) << text;
    EXPECT_NE(text.find(kNoStepsText), std::string::npos) << text;
    EXPECT_NE(text.find("delete it"), std::string::npos) << text;
  }

  const TempFolder folder_;
  const std::string file_ = folder_.File("lesson1.run");
  const std::string left_ = folder_.File("left.run");
  const SampleRun sample_;
  std::string error_;
};

TEST_F(RunReaderJournalTest, AKillWhileItIsMadePlainIsMended) {
  sample_.Write(file_, {.page_size = 512});
  KillAmid(file_, ManyChanges());
  std::string error;
  ASSERT_THROW(Database::Open(left_, Database::Access::kReadOnly, error)->Integer("SELECT 1 FROM meta"),
               DatabaseError)
      << "the journal is hot";
  ASSERT_EQ(UnmergedLog(left_), left_ + "-journal");
  const auto reader = RunReader::Open(left_, error);
  ASSERT_NE(reader, nullptr) << error;
  EXPECT_TRUE(reader->mended());
  EXPECT_FALSE(reader->has_log());
  EXPECT_FALSE(fs::exists(left_ + "-journal"));
  EXPECT_EQ(reader->extent().last, 20u);
  reader->UseScenario(sample_.scenario());
  const auto read = reader->Read(20);
  ASSERT_TRUE(read) << reader->error();
  EXPECT_EQ(read->hash, StateHash(*sample_.FrameAt(20)));
  EXPECT_FALSE(RunReader::Open(left_, error)->mended()) << "once is enough";
}

TEST_F(RunReaderJournalTest, AStrangersJournalIsLeftAlone) {
  Change(file_, "CREATE TABLE step(hash, poses); CREATE TABLE meta(value)");
  Change(file_,
         "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 50)"
         " INSERT INTO step SELECT i, zeroblob(3000) FROM n");
  KillAmid(file_, ManyChanges());
  const auto bytes = fs::file_size(left_);
  EXPECT_NE(Refusal(left_).find("is a database of another program"), std::string::npos) << error_;
  EXPECT_TRUE(fs::exists(left_ + "-journal"));
  EXPECT_EQ(fs::file_size(left_), bytes);
}

TEST_F(RunReaderJournalTest, AJournalThatNamesAFileToDeleteIsLeftAlone) {
  sample_.Write(file_, {.page_size = 512});
  KillAmid(file_, ManyChanges());
  std::ofstream(left_ + "-journal", std::ios::binary | std::ios::app) << "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7";
  EXPECT_NE(Refusal(left_), "");
  EXPECT_TRUE(fs::exists(left_ + "-journal"));
}

TEST_F(RunReaderJournalTest, AKillWhileItIsMadeSaysThatNothingWasRecorded) {
  const std::string id = "PRAGMA application_id = " + std::to_string(kRunApplicationId) + ";";
  const std::string format = "PRAGMA user_version = " + std::to_string(kRunFormat) + ";";
  std::ofstream(folder_.File("empty.run"));
  ExpectNoSteps(folder_.File("empty.run"));
  Change(folder_.File("id.run"), id);
  ExpectNoSteps(folder_.File("id.run"));
  Change(folder_.File("format.run"), id + format);
  ExpectNoSteps(folder_.File("format.run"));
  Change(folder_.File("wal.run"), id + format + "PRAGMA journal_mode = WAL;");
  ExpectNoSteps(folder_.File("wal.run"));
}

TEST_F(RunReaderJournalTest, AKillAmidTheFirstPageIsRolledBackToNothing) {
  const std::string id = "PRAGMA application_id = " + std::to_string(kRunApplicationId) + ";";
  KillAmid(file_, id + "CREATE TABLE t(x); INSERT INTO t VALUES(zeroblob(200000));");
  const std::string page = folder_.File("page.run");
  Change(page, id);
  fs::copy_file(page, left_, fs::copy_options::overwrite_existing);
  ASSERT_GT(fs::file_size(left_), 0u);
  ExpectNoSteps(left_);
  EXPECT_EQ(fs::file_size(left_), 0u);
}

TEST_F(RunReaderJournalTest, ARecorderThatHasOnlyJustBegunIsNotOverwritten) {
  const auto recorder = Change(file_, "PRAGMA application_id = " + std::to_string(kRunApplicationId) +
                                          "; PRAGMA user_version = " + std::to_string(kRunFormat) +
                                          "; PRAGMA journal_mode = WAL; BEGIN; CREATE TABLE meta(key)");
  std::string error;
  const OpenedRun run = OpenRun(file_, error);
  EXPECT_EQ(run.database, nullptr);
  EXPECT_TRUE(run.growing);
  EXPECT_NE(error.find("try again"), std::string::npos) << error;
}

TEST_F(RunReaderJournalTest, ALogThatCannotBeMergedIsToldWithItsReason) {
  std::string remark, error;
  const auto writer = sample_.Write(file_, {.close = false});
  const auto other = Change(file_, "BEGIN; SELECT * FROM step");
  ASSERT_TRUE(writer->Close(remark));
  const auto reader = RunReader::Open(file_, error);
  ASSERT_NE(reader, nullptr) << error;
  EXPECT_FALSE(reader->growing());
  EXPECT_TRUE(reader->has_log());
  EXPECT_EQ(UnmergedLog(file_), file_ + "-wal");
  EXPECT_EQ(reader->log_reason(), "another program reads it");
}

TEST_F(RunReaderJournalTest, AClosedFileHasNoLog) {
  sample_.Write(file_);
  const auto reader = RunReader::Open(file_, error_);
  ASSERT_NE(reader, nullptr) << error_;
  EXPECT_FALSE(reader->has_log());
  EXPECT_EQ(reader->log_reason(), "");
  EXPECT_EQ(UnmergedLog(file_), "");
}

}  // namespace
}  // namespace coopdyn

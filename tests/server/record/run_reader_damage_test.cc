// SPDX-License-Identifier: MIT
// No file is trusted: one that is no recording, or a damaged one, is an error text and never a crash.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "server/record/run_reader.h"
#include "server/record/sqlite_db.h"
#include "tests/server/record/run_reader_sample.h"

namespace coopdyn {
namespace {

namespace fs = std::filesystem;

std::string ReadBytes(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void WriteBytes(const std::string& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

class RunReaderDamageTest : public testing::Test {
 protected:
  /// The error text if `file_` is refused; empty if it is opened.
  std::string Refusal() {
    std::string error;
    reader_ = RunReader::Open(file_, error);
    EXPECT_EQ(reader_ == nullptr, !error.empty());
    if (reader_ != nullptr) {
      reader_->UseScenario(sample_.scenario());
    } else {
      EXPECT_EQ(error.rfind(file_, 0), 0u) << error;
    }
    return error;
  }
  /// Changes the closed sample by SQL, as an attacker would, and opens it.
  std::string RefusalAfter(const std::string& sql) {
    sample_.Write(file_);
    std::string error;
    const auto database = Database::Open(file_, Database::Access::kReadWrite, error);
    EXPECT_TRUE(database->Try(sql)) << database->error();
    return Refusal();
  }
  /// Calls every query of a reader.
  void ReadAll() {
    if (reader_ == nullptr) return;
    const RunExtent extent = reader_->extent();
    const std::uint64_t last = std::min(extent.last, extent.first + 100);
    for (const bool inputs_only : {true, false}) {
      reader_->ForEach(extent.first, last, inputs_only, [](const RecordedStep&) { return true; });
    }
    for (std::uint64_t step = extent.first; step <= last; step += 3) {
      reader_->Read(step);
      reader_->Keyframe(step);
      reader_->NextShown(step, false);
      reader_->StepAt(static_cast<Nanoseconds>(step) * SampleRun::kStep, true);
    }
    reader_->Keyframes();
    reader_->Inputs(0, last);
    reader_->Events();
    reader_->Contents();
    for (std::uint64_t scene = 0; scene < 3; ++scene) reader_->SceneOf(scene);
  }

  const TempFolder folder_;
  const std::string file_ = folder_.File("lesson1.run");
  const SampleRun sample_;
  std::unique_ptr<RunReader> reader_;
};

#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

TEST_F(RunReaderDamageTest, AnInputThatIsNoneIsDamage) {
  ASSERT_EQ(RefusalAfter("UPDATE input SET detail = 'backwards' WHERE action = 'set_mode'"), "");
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(reader_->Inputs(0, 20).empty());
    EXPECT_NE(reader_->error().find("is damaged"), std::string::npos) << reader_->error();
  }
}

TEST_F(RunReaderDamageTest, SaysThatThereIsNoSuchFile) {
  EXPECT_SAYS(Refusal(), "there is no such file");
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(RunReaderDamageTest, SaysThatAFolderIsNoRecording) {
  fs::create_directory(file_);
  EXPECT_SAYS(Refusal(), "is a folder: write the name of a recording in it");
}

TEST_F(RunReaderDamageTest, SaysThatAnEmptyFileHoldsNothing) {
  WriteBytes(file_, "");
  EXPECT_SAYS(Refusal(), "is empty");
}

TEST_F(RunReaderDamageTest, SaysThatAForeignFileIsNoRecording) {
  WriteBytes(file_, std::string(5000, 'x'));
  EXPECT_SAYS(Refusal(), "is not a recording of coopdyn: it is no SQLite database");
  EXPECT_SAYS(Refusal(), "coopdyn serve --record");
}

TEST_F(RunReaderDamageTest, ADatabaseOfAnotherProgramIsNotTouched) {
  std::string error;
  auto database = Database::Open(file_, Database::Access::kCreate, error);
  ASSERT_TRUE(database->Try("PRAGMA journal_mode = WAL; CREATE TABLE meta(key, value)"));
  EXPECT_SAYS(Refusal(), "it is a database of another program");
  EXPECT_EQ(database->Text("PRAGMA journal_mode"), "wal");
  database.reset();
  database = Database::Open(file_, Database::Access::kReadWrite, error);
  EXPECT_EQ(database->Integer("SELECT count(*) FROM meta"), 0);
}

TEST_F(RunReaderDamageTest, SaysThatAProgramOfAnotherFormatMadeIt) {
  EXPECT_SAYS(RefusalAfter("PRAGMA user_version = 1"), "was recorded in format 1 by an older coopdyn");
  EXPECT_SAYS(RefusalAfter("PRAGMA user_version = 3"), "was recorded in format 3 by a newer coopdyn");
  EXPECT_SAYS(RefusalAfter("PRAGMA user_version = 0"), "is damaged: its format is 0");
}

TEST_F(RunReaderDamageTest, SaysWhichWordOfTheHeaderIsWrong) {
  EXPECT_SAYS(RefusalAfter("UPDATE meta SET value = 'warp' WHERE key = 'mode'"), "'warp' for mode");
}

TEST_F(RunReaderDamageTest, AStepLengthOfZeroIsDamage) {
  EXPECT_SAYS(RefusalAfter("UPDATE meta SET value = 0 WHERE key = 'step_ns'"), "'0' for step_ns");
}

TEST_F(RunReaderDamageTest, SaysThatItHoldsNoSteps) {
  EXPECT_SAYS(RefusalAfter("DELETE FROM step"), "holds no steps");
}

TEST_F(RunReaderDamageTest, AMissingTableIsDamage) {
  for (const char* table : {"meta", "text", "step", "keyframe", "scene"}) {
    const std::string text = RefusalAfter(std::string("DROP TABLE ") + table);
    EXPECT_SAYS(text, std::string("no such table: ") + table);
  }
}

TEST_F(RunReaderDamageTest, AMissingTableOfInputsIsSaidWhenAskedFor) {
  EXPECT_EQ(RefusalAfter("DROP TABLE input; DROP TABLE event"), "");
  EXPECT_TRUE(reader_->Inputs(0, 20).empty());
  EXPECT_SAYS(reader_->error(), "no such table: input");
  EXPECT_TRUE(reader_->Events().empty());
  EXPECT_SAYS(reader_->error(), "no such table: event");
}

TEST_F(RunReaderDamageTest, PosesOfAnotherLengthAreDamage) {
  EXPECT_EQ(RefusalAfter("UPDATE step SET poses = x'0011' WHERE step = 4"), "");
  EXPECT_FALSE(reader_->Read(4));
  EXPECT_SAYS(reader_->error(), "is damaged (the poses of step 4)");
  EXPECT_TRUE(reader_->Read(5)) << "its neighbour is whole";
}

TEST_F(RunReaderDamageTest, EveryBlobIsChecked) {
  const std::pair<const char*, const char*> columns[] = {{"commands", "the commands of step 4"},
                                                         {"messages", "the broadcasts of step 4"},
                                                         {"channels", "the channels of step 4"},
                                                         {"distances", "the distances of step 4"},
                                                         {"targets", "the sighted targets of step 4"}};
  for (const auto& [column, text] : columns) {
    EXPECT_EQ(RefusalAfter(std::string("UPDATE step SET ") + column + " = x'0011223344' WHERE step = 4"), "");
    EXPECT_FALSE(reader_->Read(4)) << column;
    EXPECT_SAYS(reader_->error(), text);
    EXPECT_FALSE(reader_->ForEach(0, 20, false, [](const RecordedStep&) { return true; }));
    EXPECT_SAYS(reader_->error(), text);
  }
}

TEST_F(RunReaderDamageTest, ACommandForARobotThatIsNotThereIsDamage) {
  // Channel 50, a position of 0.
  EXPECT_EQ(RefusalAfter("UPDATE step SET commands = x'32000000' || x'01' || zeroblob(8) WHERE step = 4"),
            "");
  EXPECT_FALSE(reader_->Read(4, true));
  EXPECT_SAYS(reader_->error(), "the commands of step 4");
}

TEST_F(RunReaderDamageTest, AnotherTypeThanAnIntegerIsDamageOrNumber) {
  EXPECT_EQ(RefusalAfter("UPDATE step SET time_ns = 'soon', scene = -3 WHERE step = 4"), "");
  EXPECT_FALSE(reader_->Read(4));
  EXPECT_SAYS(reader_->error(), "step 4");
}

TEST_F(RunReaderDamageTest, NegativeStepNumbersAreDamage) {
  EXPECT_SAYS(RefusalAfter("UPDATE step SET step = -5 WHERE step = 0"), "a step number or time below 0");
}

TEST_F(RunReaderDamageTest, ALastStepBelowAllTellsOfNoMissingOnes) {
  EXPECT_EQ(RefusalAfter("INSERT OR REPLACE INTO meta VALUES ('last_step', -9223372036854775808)"), "");
  EXPECT_EQ(reader_->extent().missing, 0u);
}

TEST_F(RunReaderDamageTest, AMissingKeyframeIsSaid) {
  EXPECT_EQ(RefusalAfter("DELETE FROM keyframe WHERE step < 10"), "");
  EXPECT_EQ(reader_->Keyframe(5), nullptr);
  EXPECT_SAYS(reader_->error(), "the keyframe at or before step 5 is missing");
  EXPECT_NE(reader_->Keyframe(20), nullptr);
}

TEST_F(RunReaderDamageTest, AKeyframeThatIsNoStateIsDamage) {
  EXPECT_EQ(RefusalAfter("UPDATE keyframe SET state = zeroblob(70000) WHERE step = 8"), "");
  EXPECT_EQ(reader_->Keyframe(9), nullptr);
  EXPECT_SAYS(reader_->error(), "is damaged (the keyframe of step 8)");
}

TEST_F(RunReaderDamageTest, AKeyframeOfAnotherStepIsDamage) {
  EXPECT_EQ(RefusalAfter("UPDATE keyframe SET step = 9 WHERE step = 8"), "");
  EXPECT_EQ(reader_->Keyframe(9), nullptr);
  EXPECT_SAYS(reader_->error(), "is damaged (the keyframe of step 9)");
}

TEST_F(RunReaderDamageTest, AMissingSceneIsDamage) {
  EXPECT_EQ(RefusalAfter("UPDATE step SET scene = 42 WHERE step = 4"), "");
  EXPECT_FALSE(reader_->Read(4));
  EXPECT_SAYS(reader_->error(), "scene 42");
  EXPECT_EQ(RefusalAfter("UPDATE scene SET description = x'ff'"), "");
  EXPECT_FALSE(reader_->Read(4));
  EXPECT_SAYS(reader_->error(), "is damaged (scene 1)");
}

TEST_F(RunReaderDamageTest, AScenarioThatCannotBeReadSaysWhere) {
  sample_.Write(file_);
  std::string error;
  const auto database = Database::Open(file_, Database::Access::kReadWrite, error);
  ASSERT_TRUE(
      database->Try("UPDATE text SET content = '[ROBOT_1]' || char(10) || 'type warp' WHERE kind = "
                    "'scenario'"));
  const auto reader = RunReader::Open(file_, error);
  ASSERT_NE(reader, nullptr) << error;
  Diagnostics diagnostics;
  EXPECT_EQ(reader->LoadScenario(SourcePath(), diagnostics), nullptr);
  EXPECT_SAYS(diagnostics.ToString(), "warp");
}

TEST_F(RunReaderDamageTest, HostileSchemasRunNoCode) {
  RefusalAfter("ALTER TABLE step RENAME TO real_step; CREATE VIEW step AS SELECT * FROM real_step");
  EXPECT_EQ(reader_, nullptr);
  RefusalAfter(
      "CREATE TRIGGER t AFTER INSERT ON meta BEGIN DELETE FROM step; END; UPDATE meta SET value = 0 "
      "WHERE key = 'closed'");
  ASSERT_NE(reader_, nullptr);
  EXPECT_EQ(reader_->extent().last, 20u);
}

TEST_F(RunReaderDamageTest, TruncatedAnywhereItIsReadWithoutACrash) {
  sample_.Write(file_, {.page_size = 4096});
  const std::string whole = ReadBytes(file_);
  ASSERT_GT(whole.size(), 50000u);
  for (std::size_t cut = 0; cut < 50; ++cut) {
    WriteBytes(file_, whole.substr(0, whole.size() * cut / 50 + (cut % 7)));
    EXPECT_NE(Refusal(), "") << cut << " " << whole.size();
    ReadAll();
  }
}

TEST_F(RunReaderDamageTest, FlippedBytesAnywhereAreReadWithoutACrash) {
  sample_.Write(file_, {.page_size = 4096});
  const std::string whole = ReadBytes(file_);
  const std::size_t regions = 120;
  for (std::size_t region = 0; region < regions; ++region) {
    std::string bytes = whole;
    const std::size_t first = whole.size() * region / regions;
    for (std::size_t at = first; at < std::min(first + 200, whole.size()); at += 1 + region % 17) {
      bytes[at] = static_cast<char>(bytes[at] ^ (region % 3 == 0 ? 0xff : 0x41));
    }
    WriteBytes(file_, bytes);
    Refusal();
    ReadAll();
  }
}

TEST_F(RunReaderDamageTest, RandomPagesAreReadWithoutACrash) {
  sample_.Write(file_, {.page_size = 4096});
  const std::string whole = ReadBytes(file_);
  const std::size_t pages = whole.size() / 4096;
  std::uint32_t random = 12345;
  for (std::size_t page = 1; page < pages; ++page) {
    std::string bytes = whole;
    for (std::size_t i = 0; i < 4096; ++i) {
      random = random * 1664525 + 1013904223;
      bytes[page * 4096 + i] = static_cast<char>(random >> 24);
    }
    WriteBytes(file_, bytes);
    Refusal();
    ReadAll();
  }
}

TEST_F(RunReaderDamageTest, AFileThatWasReplacedWhileItWasReadIsNoDamage) {
  sample_.Write(file_);
  ASSERT_EQ(Refusal(), "");
  RemoveRunFile(file_);
  const auto other = sample_.Write(file_, {.steps = 2, .close = false});
  EXPECT_FALSE(reader_->Read(9));
  EXPECT_EQ(reader_->error(), file_ + " was replaced by another file while it was read: open it again");
}

}  // namespace
}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// The chains of a run file: that they agree with the docs, and the changes that they detect.
#include "server/record/run_chain.h"

#include <gmock/gmock.h>

#include "record_fixture.h"
#include "server/record/run_reader.h"
#include "tests/server/record/rechain.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

/// 30 steps, of which 12 to 14 were lost, two scenes, four keyframes, inputs and events.
class RunChainTest : public ::testing::Test {
 protected:
  RunChainTest() { Record(true); }

  void Record(bool close) {
    FrameMaker maker(RecordScene());
    const SavedStatePtr start = maker.Start();
    writer_ = MakeWriter(file_, *start);
    for (std::uint64_t step = 1; step <= 30; ++step) {
      if (step >= 12 && step <= 14) continue;
      if (step == 20) maker.SetScene(RecordScene(std::string(kRecordScenario) + kMore));
      SavedState state;
      state.frame = maker.Make(step);
      if (step == 15) {
        EXPECT_TRUE(writer_->AddLost(3));
      }
      EXPECT_TRUE(writer_->AddStep(*state.frame));
      if (step % 10 == 0 || step == 15) {
        EXPECT_TRUE(writer_->AddKeyframe(state));
      }
      if (step % 6 == 0) {
        EXPECT_TRUE(writer_->AddInput({step, edit::UnloadController{"robot1"}}));
      }
      if (step % 7 == 0) {
        EXPECT_TRUE(writer_->AddEvent({step, 0.01 * static_cast<double>(step), "note", "\u00fcber"}));
      }
      if (step % 9 == 0) {
        EXPECT_TRUE(writer_->Commit());
      }
    }
    if (!close) return;
    std::string remark;
    EXPECT_TRUE(writer_->Close(remark));
    writer_.reset();
  }
  void Change(const std::string& sql) const {
    std::string error;
    const auto database = Database::Open(file_, Database::Access::kReadWrite, error);
    ASSERT_NE(database, nullptr) << error;
    ASSERT_TRUE(database->Try(sql)) << database->error();
  }
  std::unique_ptr<RunChain> Open() const {
    std::string error;
    auto chain = RunChain::Open(file_, error);
    EXPECT_NE(chain, nullptr) << error;
    return chain;
  }
  /// All findings in the file: "" or e.g. "22 event 3 chain".
  std::string Find() const {
    const auto chain = Open();
    std::string ends;
    const auto damage = chain->CheckRest(ends);
    EXPECT_EQ(chain->error(), "");
    const std::string head = chain->CheckHead();
    if (damage) return std::to_string(damage->step) + " " + damage->what + " " + damage->field;
    return ends.empty() ? head : ends;
  }

  TempFolder folder_;
  const std::string file_ = folder_.File("lesson1.run");
  std::unique_ptr<RunWriter> writer_;
  static constexpr const char* kMore = "[BOX_2]\ntype box\nsize 0.5 0.5 0.5\nposition -3 3\nmass 2kg\n";
};

TEST_F(RunChainTest, AnOlderFileWithoutAColumnOfScoresIsWhole) {
  Change("ALTER TABLE step DROP COLUMN scores");
  EXPECT_NE(Find(), "") << "the chain knows of the column";
  Rechain(file_);
  EXPECT_EQ(Find(), "");
  std::string error;
  const auto reader = RunReader::Open(file_, error);
  ASSERT_NE(reader, nullptr) << error;
  EXPECT_FALSE(reader->has_scores());
  Diagnostics diagnostics;
  ASSERT_NE(reader->LoadScenario(SourcePath(), diagnostics), nullptr) << diagnostics.ToString();
  const auto step = reader->Read(5);
  ASSERT_TRUE(step) << reader->error();
  EXPECT_TRUE(step->scores.empty());
  EXPECT_FALSE(step->bodies.empty());
}

TEST_F(RunChainTest, AFileThatAnotherProgramHoldsWasNotChanged) {
  std::string error;
  const auto other = Database::Open(file_, Database::Access::kReadWrite, error);
  const auto chain = Open();
  ASSERT_TRUE(other->Try("BEGIN EXCLUSIVE"));
  EXPECT_EQ(chain->CheckHead(), "");
  EXPECT_THAT(chain->error(), HasSubstr("another program holds it, try again"));
  EXPECT_EQ(RunChain::Open(file_, error), nullptr);
  EXPECT_THAT(error, HasSubstr("another program holds it, try again"));
}

TEST_F(RunChainTest, ChainsAreThoseThatTheDocsTellOf) {
  const std::string written = Rechainer(file_).Dump();
  Rechain(file_);
  EXPECT_EQ(Rechainer(file_).Dump(), written);
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM scene"), 2);
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM keyframe"), 5);
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM input"), 4);
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM event"), 3);
  EXPECT_EQ(Ask(file_, "SELECT count(DISTINCT chain) FROM step"), 28);
}

TEST_F(RunChainTest, AChainTakesFiveBytesOfARow) {
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step WHERE chain BETWEEN -2147483648 AND 2147483647"), 28);
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step WHERE typeof(chain) = 'integer'"), 28);
}

TEST_F(RunChainTest, AFileAsItWasWrittenIsRightThoughStepsWereLost) {
  EXPECT_EQ(Find(), "");
  const auto chain = Open();
  for (std::uint64_t step = 0; step <= 30; ++step) EXPECT_FALSE(chain->CheckRows(step)) << step;
  EXPECT_FALSE(chain->CheckKeyframes(30));
}

TEST_F(RunChainTest, WhatIsCommittedIsSealedWhileItIsRecorded) {
  std::filesystem::remove(file_);
  Record(false);
  EXPECT_EQ(Find(), "");
  EXPECT_EQ(Ask(file_, "SELECT max(step) FROM step"), 27);
  writer_.reset();  // like a crash
  std::string error;
  const auto reader = RunReader::Open(file_, error);
  ASSERT_NE(reader, nullptr) << error;
  EXPECT_TRUE(reader->mended());
  EXPECT_EQ(Find(), "");
}

TEST_F(RunChainTest, MendingDoesNotSealWhatWasChangedBefore) {
  Change("UPDATE meta SET value = 0 WHERE key = 'closed'; DELETE FROM meta WHERE key = 'last_step'");
  std::string error;
  ASSERT_TRUE(RunReader::Open(file_, error)->mended());
  EXPECT_THAT(Find(), HasSubstr("its table meta was changed"));
}

TEST_F(RunChainTest, AGrowingFileIsFollowed) {
  std::filesystem::remove(file_);
  Record(false);
  const auto chain = Open();
  std::string ends;
  EXPECT_FALSE(chain->CheckRest(ends));
  EXPECT_EQ(ends, "");
  EXPECT_TRUE(writer_->AddInput({30, edit::SetMode{Mode::kFree}}));
  EXPECT_TRUE(writer_->AddEvent({30, 0.3, "info", "free now"}));
  EXPECT_TRUE(writer_->Commit());
  EXPECT_FALSE(chain->CheckRest(ends));
  EXPECT_EQ(ends, "");
}

struct Tampering {
  const char* name;
  const char* sql;
  const char* found;
};

class TamperingTest : public RunChainTest, public ::testing::WithParamInterface<Tampering> {};

TEST_P(TamperingTest, IsNamed) {
  Change(GetParam().sql);
  EXPECT_THAT(Find(), HasSubstr(GetParam().found));
}

INSTANTIATE_TEST_SUITE_P(
    All, TamperingTest,
    ::testing::Values(
        Tampering{"Commands", "UPDATE step SET commands = NULL WHERE step = 5", "5 the row of step 5 chain"},
        Tampering{"EmptyBlob", "UPDATE step SET messages = x'' WHERE step = 5", "5 the row of step 5 chain"},
        Tampering{"Hash", "UPDATE step SET hash = hash + 1 WHERE step = 30", "30 the row of step 30 chain"},
        Tampering{"FirstStep", "UPDATE step SET time_ns = 1 WHERE step = 0", "0 the row of step 0 chain"},
        Tampering{"StepOut", "DELETE FROM step WHERE step = 7", "8 the row of step 8 chain"},
        Tampering{"StepIn",
                  "INSERT INTO step SELECT 13, time_ns, hash, scene, commands, messages, channels, "
                  "distances, targets, poses, scores, chain FROM step WHERE step = 11",
                  "13 the row of step 13 chain"},
        Tampering{"StepsSwapped",
                  "UPDATE step SET step = -1 WHERE step = 3; UPDATE step SET step = 3 WHERE step = 4; "
                  "UPDATE step SET step = 4 WHERE step = -1",
                  "3 the row of step 3 chain"},
        Tampering{"StepBelowZero", "UPDATE step SET step = -5 WHERE step = 0", "0 the row of step -5 chain"},
        Tampering{"Chain", "UPDATE step SET chain = chain + 1 WHERE step = 9", "9 the row of step 9 chain"},
        Tampering{"ChainNull", "UPDATE step SET chain = NULL WHERE step = 9", "9 the row of step 9 chain"},
        Tampering{"ChainText", "UPDATE step SET chain = 'abc' WHERE step = 9", "9 the row of step 9 chain"},
        Tampering{"ChainBeyond", "UPDATE step SET chain = chain + 4294967296 WHERE step = 9",
                  "9 the row of step 9 chain"},
        Tampering{"StepsCutOff", "DELETE FROM step WHERE step > 28", "its table step ends with row 28"},
        Tampering{"StepsCutOffAndSaid",
                  "DELETE FROM step WHERE step > 28; UPDATE meta SET value = 28 WHERE key = 'last_step'",
                  "its table step ends with row 28"},
        Tampering{"Keyframe", "UPDATE keyframe SET state = state || x'00' WHERE step = 15",
                  "15 the keyframe of step 15 chain"},
        Tampering{"KeyframeOut", "DELETE FROM keyframe WHERE step = 15", "20 the keyframe of step 20 chain"},
        Tampering{"LastKeyframeOut", "DELETE FROM keyframe WHERE step = 30",
                  "its table keyframe ends with row 20"},
        Tampering{"Input", "UPDATE input SET detail = 'robot2' WHERE id = 2", "18 input 2 chain"},
        Tampering{"InputOut", "DELETE FROM input WHERE id = 2", "24 input 2 row"},
        Tampering{"FirstInputOut", "DELETE FROM input WHERE id = 1", "18 input 1 row"},
        Tampering{"LastInputOut", "DELETE FROM input WHERE id = 4", "its table input ends with row 3"},
        Tampering{"InputElsewhere", "UPDATE input SET step = 9000 WHERE id = 1", "9000 input 1 chain"},
        Tampering{"Event", "UPDATE event SET text = 'uber' WHERE id = 1", "7 event 1 chain"},
        Tampering{"EventAsBytes", "UPDATE event SET text = CAST(text AS BLOB) WHERE id = 1",
                  "7 event 1 chain"},
        Tampering{"EventOutAndRenumbered",
                  "DELETE FROM event WHERE id = 2; UPDATE event SET id = 2 WHERE id = 3", "28 event 2 chain"},
        Tampering{"EventIn",
                  "INSERT INTO event SELECT 4, step, time_ns, level, text, 0 FROM event WHERE id = 1",
                  "7 event 4 chain"},
        Tampering{"AllEventsOut", "DELETE FROM event", "its table event ends with row 0"},
        Tampering{"Scene", "UPDATE scene SET first_step = 21 WHERE id = 2", "21 scene 2 chain"},
        Tampering{"SceneOut", "DELETE FROM scene WHERE id = 1", "20 scene 1 row"},
        Tampering{"Body", "UPDATE body SET name = 'BOX_9' WHERE scene = 2 AND place = 0", "20 scene 2 chain"},
        Tampering{"Robot", "UPDATE robot SET p_x = p_x + 1 WHERE scene = 1 AND place = 0", "0 scene 1 chain"},
        Tampering{"Channel", "UPDATE channel SET joint = 'elbow' WHERE scene = 2 AND place = 1",
                  "20 scene 2 chain"},
        Tampering{"Target", "DELETE FROM target WHERE scene = 1 AND place = 1", "0 scene 1 chain"},
        Tampering{"Meta", "UPDATE meta SET value = 'coopdyn serve' WHERE key = 'command'",
                  "its table meta was changed"},
        Tampering{"MetaKind", "UPDATE meta SET value = '0' WHERE key = 'pose_every_ns'",
                  "its table meta was changed"},
        Tampering{"MetaLost", "UPDATE meta SET value = 4 WHERE key = 'lost'", "its table meta was changed"},
        Tampering{"Seal", "UPDATE meta SET value = 'abc' WHERE key = 'seal'", "its table meta was changed"},
        Tampering{"SealOut", "DELETE FROM meta WHERE key = 'seal'", "its table meta was changed"},
        Tampering{"Ends", "UPDATE meta SET value = NULL WHERE key = 'ends'",
                  "does not say where its tables end"},
        Tampering{"Texts", "UPDATE meta SET value = NULL WHERE key = 'texts'", "a text that it carries"},
        Tampering{"Text", "UPDATE text SET content = content || ' ' WHERE kind = 'robot'",
                  "a text that it carries"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_F(RunChainTest, TheFirstOfSeveralChangesIsNamed) {
  Change(
      "UPDATE step SET hash = 0 WHERE step = 25; UPDATE event SET text = '' WHERE id = 2;"
      "UPDATE keyframe SET state = x'00' WHERE step = 20");
  EXPECT_EQ(Find(), "20 the keyframe of step 20 chain");
}

TEST_F(RunChainTest, AWalkStepByStepFindsRowsWithTheirStep) {
  Change("UPDATE event SET text = '' WHERE id = 2; UPDATE step SET hash = 0 WHERE step = 25");
  const std::int64_t step = Ask(file_, "SELECT step FROM event WHERE id = 2");
  ASSERT_EQ(step, 21);
  const auto chain = Open();
  for (std::uint64_t k = 0; k < 21; ++k) EXPECT_FALSE(chain->CheckRows(k)) << k;
  const auto event = chain->CheckRows(21);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->what, "event 2");
  for (std::uint64_t k = 22; k < 25; ++k) EXPECT_FALSE(chain->CheckRows(k)) << k;
  const auto row = chain->CheckRows(25);
  ASSERT_TRUE(row);
  EXPECT_EQ(row->what, "the row of step 25");
  // The later rows are unchanged.
  for (std::uint64_t k = 26; k <= 30; ++k) EXPECT_FALSE(chain->CheckRows(k)) << k;
}

TEST_F(RunChainTest, WhatStandsInsteadOfAChainIsTold) {
  Change("UPDATE step SET chain = NULL WHERE step = 2; UPDATE step SET chain = 'abc' WHERE step = 4");
  const auto chain = Open();
  EXPECT_EQ(chain->CheckRows(2)->recorded, "NULL");
  EXPECT_EQ(chain->CheckRows(3)->what, "the row of step 3");  // its predecessor is missing
  EXPECT_EQ(chain->CheckRows(4)->recorded, "no whole number");
}

TEST_F(RunChainTest, AFileWithoutChainsIsSaid) {
  Change("ALTER TABLE input DROP COLUMN chain");
  std::string error;
  EXPECT_EQ(RunChain::Open(file_, error), nullptr);
  EXPECT_THAT(error, HasSubstr("lesson1.run: no such column: chain: without a chain of its rows"));
  EXPECT_THAT(error, HasSubstr("record it again"));
  EXPECT_NE(RunReader::Open(file_, error), nullptr) << error;  // it can be played
}

}  // namespace
}  // namespace coopdyn

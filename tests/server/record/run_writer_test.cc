// SPDX-License-Identifier: MIT
#include "server/record/run_writer.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "record_fixture.h"
#include "server/record/pose_codec.h"
#include "server/record/run_tables.h"
#include "server/record/state_codec.h"
#include "server/record/step_row.h"

namespace coopdyn {
namespace {

/// Opens a file and keeps it open, for columns that are bytes.
class RunFile {
 public:
  explicit RunFile(const std::string& file) {
    std::string error;
    database_ = Database::Open(file, Database::Access::kReadOnly, error);
    EXPECT_NE(database_, nullptr) << error;
  }
  std::vector<std::byte> Blob(const std::string& sql) {
    Statement row = database_->Prepare(sql);
    EXPECT_TRUE(row) << database_->error();
    if (!row || row.Step() != Statement::Result::kRow) return {};
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

bool Exists(const std::string& file) {
  return std::filesystem::exists(file);
}

class RunWriterTest : public testing::Test {
 protected:
  void Close(RunWriter& writer) {
    std::string remark;
    EXPECT_TRUE(writer.Close(remark)) << writer.error();
    EXPECT_EQ(remark, "");
  }

  TestFolder folder_;
  const std::string file_ = folder_.File("test.run");
  FrameMaker maker_{RecordScene()};
};

TEST_F(RunWriterTest, AClosedRecordingIsOnePlainFile) {
  const auto writer = MakeWriter(file_, *maker_.Start());
  for (std::uint64_t step = 1; step <= 20; ++step) ASSERT_TRUE(writer->AddStep(*maker_.Make(step)));
  Close(*writer);
  EXPECT_FALSE(Exists(file_ + "-wal"));
  EXPECT_FALSE(Exists(file_ + "-shm"));
  EXPECT_EQ(AskText(file_, "PRAGMA journal_mode"), "delete");
  EXPECT_EQ(AskText(file_, "PRAGMA integrity_check"), "ok");
  EXPECT_EQ(Ask(file_, "PRAGMA application_id"), kRunApplicationId);
  EXPECT_EQ(Ask(file_, "PRAGMA user_version"), 1);
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'closed'"), 1);
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 21);
  EXPECT_EQ(writer->steps(), 20U);
  EXPECT_EQ(writer->begin(), 0);
  EXPECT_EQ(writer->end(), 200'000'000);
}

TEST_F(RunWriterTest, TheHeaderSaysAllAboutTheRun) {
  Close(*MakeWriter(file_, *maker_.Start(), {true, false, false, true}, 40'000'000));
  const auto meta = [this](const std::string& key) {
    return AskText(file_, "SELECT value FROM meta WHERE key = '" + key + "'");
  };
  EXPECT_EQ(meta("format"), "1");
  EXPECT_EQ(meta("version"), "1.2.3");
  EXPECT_EQ(meta("build"), "0123456789abcdef");
  EXPECT_EQ(meta("cpu"), "a processor");
  EXPECT_EQ(meta("started"), "2026-01-02T03:04:05Z");
  EXPECT_EQ(meta("command"), "coopdyn serve test.scenario --record test.run");
  EXPECT_EQ(meta("scenario_name"), maker_.scene()->scenario->name);
  EXPECT_EQ(meta("scenario_seed"), "7");
  EXPECT_EQ(meta("seed"), "7");
  EXPECT_EQ(meta("mode"), "lockstep");
  EXPECT_EQ(meta("step_ns"), "10000000");
  EXPECT_EQ(meta("what"), "poses,wheels,controllers");
  EXPECT_EQ(meta("pose_every_ns"), "40000000");
  EXPECT_EQ(meta("lost"), "0");
  EXPECT_EQ(AskText(file_, "SELECT content FROM text WHERE kind = 'scenario'"), kRecordScenario);
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM text WHERE kind = 'robot'"), 2);
  EXPECT_EQ(AskText(file_, "SELECT content FROM text WHERE name = 'coopbot'"),
            maker_.scene()->robots[0].entry.model->text);
}

TEST_F(RunWriterTest, ASeedKeepsAll64Bits) {
  const SavedStatePtr start = maker_.Start();
  const auto frame = maker_.Make(0);
  frame->seed = ~std::uint64_t{0};
  SavedState state = *start;
  state.frame = frame;
  Close(*MakeWriter(file_, state));
  EXPECT_EQ(AskText(file_, "SELECT value FROM meta WHERE key = 'seed'"), "18446744073709551615");
}

TEST_F(RunWriterTest, TheSceneNamesBodiesRobotsAndTargets) {
  Close(*MakeWriter(file_, *maker_.Start()));
  const Scene& scene = *maker_.scene();
  const auto bodies = static_cast<std::int64_t>(scene.body_ids.size());
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM body WHERE scene = 1"), bodies);
  EXPECT_EQ(AskText(file_, "SELECT name FROM body WHERE place = 0"), scene.objects[0].object.name);
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM body WHERE place = 0 AND robot IS NULL"), 1);
  EXPECT_EQ(AskText(file_, "SELECT name FROM body WHERE place = 1"),
            "robot1." + scene.robots[0].entry.model->links[0].name);
  EXPECT_EQ(AskText(file_, "SELECT name FROM body WHERE robot = 1"), "robot2");
  EXPECT_EQ(Ask(file_, "SELECT body FROM robot WHERE name = 'robot3'"), bodies - 1);
  EXPECT_EQ(AskText(file_, "SELECT type FROM robot WHERE place = 2"), "minibot");
  EXPECT_EQ(Ask(file_, "SELECT sensors FROM robot WHERE place = 0"),
            static_cast<std::int64_t>(scene.robots[0].entry.model->distance_sensors.size()));
  EXPECT_EQ(AskText(file_, "SELECT color FROM target WHERE place = 1"), "blue");
  EXPECT_EQ(Ask(file_, "SELECT x FROM target WHERE place = 1"), -3);
  RunFile file(file_);
  EXPECT_EQ(file.Blob("SELECT description FROM scene"), EncodeScene(scene));
}

TEST_F(RunWriterTest, ARowHasHashPosesAndReadings) {
  const auto writer = MakeWriter(file_, *maker_.Start());
  const auto frame = maker_.Make(1);
  ASSERT_TRUE(writer->AddStep(*frame));
  Close(*writer);
  RunFile file(file_);
  EXPECT_EQ(Ask(file_, "SELECT hash FROM step WHERE step = 1"), static_cast<std::int64_t>(StateHash(*frame)));
  EXPECT_EQ(Ask(file_, "SELECT time_ns FROM step WHERE step = 1"), 10'000'000);
  EXPECT_EQ(Ask(file_, "SELECT scene FROM step WHERE step = 1"), 1);
  std::vector<std::byte> expected;
  EncodePoses(frame->bodies, expected);
  EXPECT_EQ(file.Blob("SELECT poses FROM step WHERE step = 1"), expected);
  expected.clear();
  EncodeWheels(frame->robots, expected);
  EXPECT_EQ(file.Blob("SELECT wheels FROM step WHERE step = 1"), expected);
  expected.clear();
  EncodeDistances(*frame, expected);
  EXPECT_EQ(file.Blob("SELECT distances FROM step WHERE step = 1"), expected);
  expected.clear();
  EncodeTargets(*frame, expected);
  EXPECT_EQ(file.Blob("SELECT targets FROM step WHERE step = 1"), expected);
}

TEST_F(RunWriterTest, WhatIsNotChosenIsNull) {
  const auto writer = MakeWriter(file_, *maker_.Start(), {});
  ASSERT_TRUE(writer->AddStep(*maker_.Make(1)));
  Close(*writer);
  EXPECT_EQ(Ask(file_,
                "SELECT count(*) FROM step WHERE wheels IS NULL AND distances IS NULL AND "
                "targets IS NULL AND messages IS NULL AND poses IS NOT NULL"),
            2);
}

TEST_F(RunWriterTest, TheFirstRowHasAllSetpointsAndIsAKeyframe) {
  const SavedStatePtr start = maker_.Start(40);
  Close(*MakeWriter(file_, *start));
  RunFile file(file_);
  const std::vector<CommandRecord> commands = file.Commands(40);
  ASSERT_EQ(commands.size(), 3U);
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(commands[i].robot, i);
    EXPECT_FALSE(commands[i].by_client);
    EXPECT_TRUE(SameBits(commands[i].setpoint, start->frame->robots[i].setpoint_rad_s));
  }
  EXPECT_EQ(file.Blob("SELECT state FROM keyframe WHERE step = 40"), EncodeState(*start));
}

TEST_F(RunWriterTest, OnlySetpointsThatChangeOrComeFromAClientAreCommands) {
  const SavedStatePtr start = maker_.Start();
  const auto writer = MakeWriter(file_, *start);
  const auto one = maker_.Make(1);
  one->robots = start->frame->robots;
  one->robots[1].setpoint_rad_s[0] += 1;
  one->robots[2].commanded = true;  // sent again, the same
  ASSERT_TRUE(writer->AddStep(*one));
  const auto two = maker_.Make(2);
  two->robots = one->robots;
  two->robots[2].commanded = false;
  ASSERT_TRUE(writer->AddStep(*two));
  Close(*writer);
  RunFile file(file_);
  const std::vector<CommandRecord> commands = file.Commands(1);
  ASSERT_EQ(commands.size(), 2U);
  EXPECT_EQ(commands[0].robot, 1U);
  EXPECT_FALSE(commands[0].by_client);
  EXPECT_EQ(commands[1].robot, 2U);
  EXPECT_TRUE(commands[1].by_client);
  EXPECT_TRUE(file.Commands(2).empty());
}

TEST_F(RunWriterTest, ZeroThatChangesItsSignIsACommand) {
  const auto zero = maker_.Make(0), minus = maker_.Make(1);
  for (RobotState& robot : zero->robots) robot.setpoint_rad_s = {0, 0};
  minus->robots = zero->robots;
  minus->robots[1].setpoint_rad_s = {-0.0, 0};
  SavedState state;
  state.frame = zero;
  const auto writer = MakeWriter(file_, state);
  ASSERT_TRUE(writer->AddStep(*minus));
  Close(*writer);
  EXPECT_EQ(RunFile(file_).Commands(1).size(), 1U);
}

/// The scene of the test with loaded controllers for robot1 and robot2.
std::shared_ptr<const Scene> DrivenScene() {
  auto scenario = std::make_shared<Scenario>(*ReadRecordScenario());
  for (std::size_t i : {0, 1}) scenario->robots[i].controller.name = "diffuse";
  return MakeScene(scenario);
}

TEST_F(RunWriterTest, SetpointsOfLoadedControllersAreLeftOutIfNotChosen) {
  maker_.SetScene(DrivenScene());
  const auto writer = MakeWriter(file_, *maker_.Start(), {});
  ASSERT_TRUE(writer->AddStep(*maker_.Make(1)));
  Close(*writer);
  const std::vector<CommandRecord> commands = RunFile(file_).Commands(1);
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(commands[0].robot, 2U);
  EXPECT_EQ(RunFile(file_).Commands(0).size(), 3U);
}

TEST_F(RunWriterTest, SetpointsOfLoadedControllersAreKeptIfChosen) {
  maker_.SetScene(DrivenScene());
  const auto writer = MakeWriter(file_, *maker_.Start(), {false, false, false, true});
  ASSERT_TRUE(writer->AddStep(*maker_.Make(1)));
  Close(*writer);
  EXPECT_EQ(RunFile(file_).Commands(1).size(), 3U);
}

TEST_F(RunWriterTest, ARobotThatLostItsControllerIsRecordedLikeAnyOther) {
  maker_.SetScene(DrivenScene());
  const auto writer = MakeWriter(file_, *maker_.Start(), {});
  ASSERT_TRUE(writer->AddInput({0, "release_robot", "robot1"}));
  ASSERT_TRUE(writer->AddStep(*maker_.Make(1)));
  Close(*writer);
  const std::vector<CommandRecord> commands = RunFile(file_).Commands(1);
  ASSERT_EQ(commands.size(), 2U);
  EXPECT_EQ(commands[0].robot, 0U);
  EXPECT_EQ(AskText(file_, "SELECT detail FROM input WHERE action = 'release_robot' AND step = 0"), "robot1");
}

TEST_F(RunWriterTest, OnlyBroadcastsOfTheStepItselfAreItsMessages) {
  const auto writer = MakeWriter(file_, *maker_.Start());
  const auto frame = maker_.Make(5);
  SentMessage sent;
  sent.message.count = 1;
  sent.step = 4;
  frame->messages = {sent, sent};
  frame->messages[1].step = 5;
  frame->messages[1].robot = 2;
  ASSERT_TRUE(writer->AddStep(*frame));
  Close(*writer);
  std::vector<SentMessage> read;
  ASSERT_TRUE(DecodeMessages(RunFile(file_).Blob("SELECT messages FROM step WHERE step = 5"), 5, read));
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].robot, 2U);
}

TEST_F(RunWriterTest, PosesOnlySoOftenButEveryStepHasARow) {
  const auto writer = MakeWriter(file_, *maker_.Start(), {true, true, true, true}, 25'000'000);
  for (std::uint64_t step = 1; step <= 20; ++step) ASSERT_TRUE(writer->AddStep(*maker_.Make(step)));
  Close(*writer);
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step WHERE hash IS NOT NULL"), 21);
  // 0, 30, 50, 80, 100, 130, 150, 180, 200 ms
  EXPECT_EQ(AskText(file_, "SELECT group_concat(step) FROM step WHERE poses IS NOT NULL"),
            "0,3,5,8,10,13,15,18,20");
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step WHERE (wheels IS NULL) <> (poses IS NULL)"), 0);
}

TEST_F(RunWriterTest, BodiesAppearAndDisappear) {
  const auto writer = MakeWriter(file_, *maker_.Start());
  ASSERT_TRUE(writer->AddStep(*maker_.Make(1)));
  maker_.SetScene(RecordScene("[ROBOT_1]\ntype minibot\nname alone\nposition 0 0\n"));
  const auto frame = maker_.Make(2);
  ASSERT_TRUE(writer->AddStep(*frame));
  ASSERT_TRUE(writer->AddStep(*maker_.Make(3)));
  Close(*writer);
  EXPECT_EQ(Ask(file_, "SELECT first_step FROM scene WHERE id = 2"), 2);
  EXPECT_EQ(Ask(file_, "SELECT scene FROM step WHERE step = 1"), 1);
  EXPECT_EQ(Ask(file_, "SELECT scene FROM step WHERE step = 3"), 2);
  EXPECT_EQ(AskText(file_, "SELECT name FROM robot WHERE scene = 2"), "alone");
  EXPECT_EQ(RunFile(file_).Commands(2).size(), 1U);
  EXPECT_EQ(RunFile(file_).Blob("SELECT poses FROM step WHERE step = 3").size(),
            1 + kPoseBytes * frame->bodies.size());
}

TEST_F(RunWriterTest, EventsAndLostStepsAreWritten) {
  const auto writer = MakeWriter(file_, *maker_.Start());
  ASSERT_TRUE(writer->AddEvent({12, 0.12, "warning", "robot1 has left the floor"}));
  ASSERT_TRUE(writer->AddLost(3));
  ASSERT_TRUE(writer->AddLost(4));
  Close(*writer);
  EXPECT_EQ(AskText(file_,
                    "SELECT text FROM event WHERE step = 12 AND time_ns = 120000000 AND "
                    "level = 'warning'"),
            "robot1 has left the floor");
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'lost'"), 7);
}

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
  ASSERT_EQ(rows.Step(), Statement::Result::kRow);  // a read is under way
  EXPECT_TRUE(writer->Close(remark));
  EXPECT_NE(remark.find("is open elsewhere"), std::string::npos) << remark;
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 2);
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'closed'"), 1);
}

TEST_F(RunWriterTest, AnExistingFileIsRefused) {
  std::ofstream(file_) << "precious";
  RunWriterOptions options;
  std::string error;
  EXPECT_EQ(RunWriter::Create(file_, options, *maker_.Start(), error), nullptr);
  EXPECT_EQ(error, file_ + " exists: choose another name, or --force");
  EXPECT_EQ(std::filesystem::file_size(file_), 8U);
}

TEST_F(RunWriterTest, AnOverwrittenFileLeavesNothingBehind) {
  std::ofstream(file_) << "old";
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
  EXPECT_FALSE(Exists(file_ + "-wal"));
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
  EXPECT_FALSE(Exists(file_));
  EXPECT_FALSE(Exists(file_ + "-wal"));
}

TEST(StepRowTest, TheBytesOfARowAreThoseThatAreWritten) {
  FrameMaker maker(RecordScene());
  TestFolder folder;
  const std::string file = folder.File("rows.run");
  const SavedStatePtr start = maker.Start();
  const RecordWhat what{true, true, true, true};
  const auto writer = MakeWriter(file, *start, what);
  constexpr std::uint64_t kSteps = 2000;
  for (std::uint64_t step = 1; step <= kSteps; ++step) {
    const auto frame = maker.Make(step);
    frame->robots = start->frame->robots;  // no commands
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

// SPDX-License-Identifier: MIT
#include "server/record/run_writer.h"

#include <utility>

#include "run_writer_fixture.h"
#include "server/record/run_tables.h"
#include "server/record/state_codec.h"
#include "server/state/pose_codec.h"

namespace coopdyn {
namespace {

TEST_F(RunWriterTest, AClosedRecordingIsOnePlainFile) {
  const auto writer = MakeWriter(file_, *maker_.Start());
  for (std::uint64_t step = 1; step <= 20; ++step) ASSERT_TRUE(writer->AddStep(*maker_.Make(step)));
  Close(*writer);
  EXPECT_FALSE(std::filesystem::exists(file_ + "-wal"));
  EXPECT_FALSE(std::filesystem::exists(file_ + "-shm"));
  EXPECT_EQ(AskText(file_, "PRAGMA journal_mode"), "delete");
  EXPECT_EQ(AskText(file_, "PRAGMA integrity_check"), "ok");
  EXPECT_EQ(Ask(file_, "PRAGMA application_id"), kRunApplicationId);
  EXPECT_EQ(Ask(file_, "PRAGMA user_version"), kRunFormat);
  EXPECT_EQ(Ask(file_, "SELECT value FROM meta WHERE key = 'closed'"), 1);
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step"), 21);
  EXPECT_EQ(writer->steps(), 20U);
  EXPECT_EQ(writer->begin(), 0);
  EXPECT_EQ(writer->end(), 200'000'000);
}

TEST_F(RunWriterTest, TheHeaderSaysAllAboutTheRun) {
  Close(*MakeWriter(file_, *maker_.Start(), {true, false, false, true}, 40'000'000));
  const std::pair<std::string, std::string> header[] = {
      {"version", "1.2.3"},
      {"build", "0123456789abcdef"},
      {"cpu", "a processor"},
      {"started", "2026-01-02T03:04:05Z"},
      {"command", "coopdyn serve test.scenario --record test.run"},
      {"scenario_name", maker_.scene()->scenario->name},
      {"scenario_seed", "7"},
      {"seed", "7"},
      {"mode", "lockstep"},
      {"step_ns", "10000000"},
      {"what", "poses,channels,controllers"},
      {"pose_every_ns", "40000000"},
      {"lost", "0"},
  };
  for (const auto& [key, value] : header) {
    EXPECT_EQ(AskText(file_, "SELECT value FROM meta WHERE key = '" + key + "'"), value) << key;
  }
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
            static_cast<std::int64_t>(scene.robots[0].entry.model->sector_count()));
  EXPECT_EQ(AskText(file_, "SELECT color FROM target WHERE place = 1"), "blue");
  EXPECT_EQ(Ask(file_, "SELECT x FROM target WHERE place = 1"), -3);
  RunFile file(file_);
  EXPECT_EQ(file.Blob("SELECT description FROM scene"), EncodeScene(scene));
}

TEST_F(RunWriterTest, ARowHasHashPosesAndReadings) {
  const auto frame = maker_.Make(1);
  Record(*maker_.Start(), {frame});
  RunFile file(file_);
  EXPECT_EQ(Ask(file_, "SELECT hash FROM step WHERE step = 1"), static_cast<std::int64_t>(StateHash(*frame)));
  EXPECT_EQ(Ask(file_, "SELECT time_ns FROM step WHERE step = 1"), 10'000'000);
  EXPECT_EQ(Ask(file_, "SELECT scene FROM step WHERE step = 1"), 1);
  const auto expect_column = [&file](const std::string& column, const auto& encode) {
    std::vector<std::byte> expected;
    encode(expected);
    EXPECT_EQ(file.Blob("SELECT " + column + " FROM step WHERE step = 1"), expected) << column;
  };
  expect_column("poses", [&](auto& bytes) { EncodePoses(frame->bodies, bytes); });
  expect_column("channels", [&](auto& bytes) { EncodeChannels(frame->channels, bytes); });
  expect_column("distances", [&](auto& bytes) { EncodeDistances(*frame, bytes); });
  expect_column("targets", [&](auto& bytes) { EncodeTargets(*frame, bytes); });
}

TEST_F(RunWriterTest, WhatIsNotChosenIsNull) {
  Record(*maker_.Start(), {maker_.Make(1)}, {});
  EXPECT_EQ(Ask(file_,
                "SELECT count(*) FROM step WHERE channels IS NULL AND distances IS NULL AND "
                "targets IS NULL AND messages IS NULL AND poses IS NOT NULL"),
            2);
}

TEST_F(RunWriterTest, OnlyBroadcastsOfTheStepItselfAreItsMessages) {
  const auto frame = maker_.Make(5);
  SentMessage sent;
  sent.message.count = 1;
  sent.step = 4;
  frame->messages = {sent, sent};
  frame->messages[1].step = 5;
  frame->messages[1].robot = 2;
  Record(*maker_.Start(), {frame});
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
  EXPECT_EQ(Ask(file_, "SELECT count(*) FROM step WHERE (channels IS NULL) <> (poses IS NULL)"), 0);
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
  EXPECT_EQ(RunFile(file_).Commands(2).size(), 2U);  // one for each wheel
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

}  // namespace
}  // namespace coopdyn

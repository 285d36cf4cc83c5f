// SPDX-License-Identifier: MIT
// The set-points of a step that a run file stores.
#include "run_writer_fixture.h"
#include "server/record/state_codec.h"

namespace coopdyn {
namespace {

TEST_F(RunWriterTest, TheFirstRowHasAllSetpointsAndIsAKeyframe) {
  const SavedStatePtr start = maker_.Start(40);
  Close(*MakeWriter(file_, *start));
  RunFile file(file_);
  const std::vector<CommandRecord> commands = file.Commands(40);
  ASSERT_EQ(commands.size(), 6U);
  for (std::uint32_t i = 0; i < 6; ++i) {
    EXPECT_EQ(commands[i].channel, i);
    EXPECT_FALSE(commands[i].by_client);
    EXPECT_TRUE(SameBits(commands[i].setpoint, start->frame->channels[i].setpoint));
  }
  EXPECT_EQ(file.Blob("SELECT state FROM keyframe WHERE step = 40"), EncodeState(*start));
}

TEST_F(RunWriterTest, OnlySetpointsThatChangeOrComeFromAClientAreCommands) {
  const SavedStatePtr start = maker_.Start();
  const auto one = maker_.Make(1);
  one->channels = start->frame->channels;
  one->channels[2].setpoint.reference += 1;
  one->commanded[2] = 1;  // sent again, the same
  const auto two = maker_.Make(2);
  two->channels = one->channels;
  Record(*start, {one, two});
  RunFile file(file_);
  const std::vector<CommandRecord> commands = file.Commands(1);
  ASSERT_EQ(commands.size(), 4U);  // of whole actuators
  for (std::uint32_t i = 0; i < 4; ++i) {
    EXPECT_EQ(commands[i].channel, i + 2);
    EXPECT_EQ(commands[i].by_client, i >= 2);
  }
  EXPECT_TRUE(file.Commands(2).empty());
}

TEST_F(RunWriterTest, ZeroThatChangesItsSignIsACommand) {
  const auto zero = maker_.Make(0), minus = maker_.Make(1);
  for (ChannelState& channel : zero->channels) channel.setpoint = {};
  minus->channels = zero->channels;
  minus->channels[2].setpoint = {-0.0};
  SavedState state;
  state.frame = zero;
  Record(state, {minus});
  EXPECT_EQ(RunFile(file_).Commands(1).size(), 2U);
}

/// The scene of the test with loaded controllers for robot1 and robot2.
std::shared_ptr<const Scene> DrivenScene() {
  auto scenario = std::make_shared<Scenario>(*ReadRecordScenario());
  for (std::size_t i : {0, 1}) scenario->robots[i].controller.name = "diffuse";
  return MakeScene(scenario);
}

TEST_F(RunWriterTest, SetpointsOfLoadedControllersAreLeftOutIfNotChosen) {
  maker_.SetScene(DrivenScene());
  Record(*maker_.Start(), {maker_.Make(1)}, {});
  const std::vector<CommandRecord> commands = RunFile(file_).Commands(1);
  ASSERT_EQ(commands.size(), 2U);
  EXPECT_EQ(commands[0].channel, 4U);
  EXPECT_EQ(RunFile(file_).Commands(0).size(), 6U);
}

TEST_F(RunWriterTest, SetpointsOfLoadedControllersAreKeptIfChosen) {
  maker_.SetScene(DrivenScene());
  Record(*maker_.Start(), {maker_.Make(1)}, {false, false, false, true});
  EXPECT_EQ(RunFile(file_).Commands(1).size(), 6U);
}

TEST_F(RunWriterTest, ARobotThatLostItsControllerIsRecordedLikeAnyOther) {
  maker_.SetScene(DrivenScene());
  const auto writer = MakeWriter(file_, *maker_.Start(), {});
  ASSERT_TRUE(writer->AddInput({0, edit::UnloadController{"robot1"}}));
  ASSERT_TRUE(writer->AddStep(*maker_.Make(1)));
  Close(*writer);
  const std::vector<CommandRecord> commands = RunFile(file_).Commands(1);
  ASSERT_EQ(commands.size(), 4U);
  EXPECT_EQ(commands[0].channel, 0U);
  EXPECT_EQ(AskText(file_, "SELECT detail FROM input WHERE action = 'release_robot' AND step = 0"), "robot1");
}

}  // namespace
}  // namespace coopdyn

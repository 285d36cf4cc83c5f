// SPDX-License-Identifier: MIT
// save, restore and get_saved of /simulation.
#include "server/control/simulation_module.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/control/simulation_fixture.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(SavedStates, AreKeptByNameAndReplaced) {
  SavedStates states;
  const auto one = std::make_shared<SavedState>();
  const auto two = std::make_shared<SavedState>();
  states.Keep("b", one);
  states.Keep("a", one);
  states.Keep("b", two);
  EXPECT_EQ(states.Names(), "start b a");
  EXPECT_EQ(states.Find("b"), two);
  EXPECT_EQ(states.Find("c"), nullptr);
}

TEST(SavedStates, AHundredAreKept) {
  SavedStates states;
  for (std::size_t i = 0; i < SavedStates::kMaxStates; ++i) {
    states.Keep("s" + std::to_string(i), std::make_shared<SavedState>());
  }
  EXPECT_THAT(states.Objection("one_more"), HasSubstr("100"));
  EXPECT_EQ(states.Objection("s7"), "");
}

TEST(SavedStates, NamesAreThoseOfRobots) {
  const SavedStates states;
  EXPECT_EQ(states.Objection("before-turn_2"), "");
  for (const char* name : {"", "2", "a b", "a/b", "_a", "größe", "start"}) {
    EXPECT_NE(states.Objection(name), "") << name;
  }
  EXPECT_EQ(states.Objection(std::string(63, 'a')), "");
  EXPECT_NE(states.Objection(std::string(64, 'a')), "");
}

class SavedStatesTest : public SimulationModuleTest {
 protected:
  SavedStatePtr SaveAs(const std::string& name) {
    auto state = std::make_shared<SavedState>();
    state->frame = world_.frames.Latest();
    next_result_.saved = state;
    EXPECT_EQ(Ask("save " + name).error, 0);
    EXPECT_NE(As<edit::Save>(applied_.back()), nullptr);
    next_result_.saved = nullptr;
    return state;
  }
};

TEST_F(SavedStatesTest, WhatIsSavedIsRestoredWithItsRobots) {
  world_.Step();
  const SavedStatePtr saved = SaveAs("before_turn");
  world_.Step();
  EXPECT_EQ(Ask("restore before_turn").error, 0);
  EXPECT_EQ(LastEdit<edit::Restore>().state, saved);
  EXPECT_EQ(applied_scenes_.size(), 1u);
}

TEST_F(SavedStatesTest, TheyAreToldWithTheirTimes) {
  world_.Step();
  SaveAs("one");
  world_.Step();
  SaveAs("two");
  const Message reply = client_->Ask("get_saved");
  EXPECT_EQ(reply.text, "start one two");
  EXPECT_THAT(reply.data, ElementsAre(0, 0.01, 0.02, 0.02, 2));
}

TEST_F(SavedStatesTest, TheyOutliveALoad) {
  const SavedStatePtr saved = SaveAs("one");
  Ask("load_scenario hall");
  EXPECT_EQ(Ask("restore one").error, 0);
  EXPECT_EQ(LastEdit<edit::Restore>().state->frame->scene, saved->frame->scene);
}

TEST_F(SavedStatesTest, TheStartIsAReset) {
  EXPECT_EQ(Ask("restore start").error, 0);
  EXPECT_FALSE(LastEdit<edit::Reset>().seed);
}

TEST_F(SavedStatesTest, UnknownNamesAreError10AndTellTheKnownOnes) {
  SaveAs("one");
  const Message reply = client_->Ask("restore two");
  EXPECT_EQ(reply.error, static_cast<std::int32_t>(Error::kNoSuchName));
  EXPECT_THAT(reply.text, HasSubstr("start one"));
}

TEST_F(SavedStatesTest, WhileARecordingIsPlayedARestoreIsError5) {
  run_.SetPlayback(PlaybackStatus{});
  const Message reply = client_->Ask("restore two");
  EXPECT_EQ(reply.error, static_cast<std::int32_t>(Error::kNotPossible));
  EXPECT_THAT(reply.text, HasSubstr("playing a recording"));
}

TEST_F(SavedStatesTest, WhatIsRefusedIsNotKept) {
  next_result_.error = Error::kNotPossible;
  next_result_.text = "playing a recording";
  EXPECT_EQ(Ask("save one").text, "playing a recording");
  EXPECT_EQ(client_->Ask("get_saved").text, "start");
  EXPECT_NE(client_->Ask("save start").error, 0);
}

TEST_F(SavedStatesTest, StrangersLookButSaveOnlyWithTheToken) {
  FakeClient stranger(*module_, 2, false);
  EXPECT_EQ(stranger.Ask("get_saved").error, 0);
  EXPECT_EQ(stranger.Ask("save one").error, static_cast<std::int32_t>(Error::kNotAllowed));
  EXPECT_EQ(stranger.Ask("restore start").error, static_cast<std::int32_t>(Error::kNotAllowed));
}

TEST_F(SavedStatesTest, StatusTellsWhatIsPlayed) {
  EXPECT_TRUE(Status().at("playback").is_null());
  PlaybackStatus playback;
  playback.file = "/data/lesson1.run";
  playback.playing = true;
  playback.end = 60'000'000'000;
  playback.speed = -2;
  run_.SetPlayback(playback);
  const json::object status = Status();
  EXPECT_EQ(status.at("state"), "playing");
  const json::object& told = status.at("playback").as_object();
  EXPECT_EQ(told.at("file"), "lesson1.run");
  EXPECT_DOUBLE_EQ(told.at("end_s").to_number<double>(), 60);
  EXPECT_EQ(told.at("speed").to_number<double>(), -2);
  playback.playing = false;
  run_.SetPlayback(playback);
  EXPECT_EQ(Status().at("state"), "paused");
}

}  // namespace
}  // namespace coopdyn

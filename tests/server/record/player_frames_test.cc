// SPDX-License-Identifier: MIT
// The frames of a playback, against the recorded run.
#include "server/record/player_frames.h"

#include <cmath>

#include "server/state/world_change.h"
#include "tests/server/record/player_fixture.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

class PlayerFramesTest : public PlayerFixture {
 protected:
  void Write(const SampleRun::Options& options) {
    sample_.Write(file_, options);
    reader_ = OpenReader();
    maker_ = std::make_unique<PlayFrames>(*reader_);
  }
  /// Checks that `frame` has the values in force at the run's step `step`.
  void ExpectInputsOf(std::uint64_t step, const Frame& frame) {
    const FramePtr run = sample_.FrameAt(step);
    for (int i = 0; i < static_cast<int>(run->scene->robots.size()); ++i) {
      EXPECT_EQ(SetpointOf(frame, i), SetpointOf(*run, i)) << step;
    }
    EXPECT_EQ(frame.commanded, run->commanded) << step;
    ASSERT_EQ(frame.messages.size(), run->messages.size()) << step;
    for (std::size_t i = 0; i < run->messages.size(); ++i) {
      EXPECT_EQ(frame.messages[i].step, step);
      EXPECT_EQ(frame.messages[i].message.values[0], run->messages[i].message.values[0]);
    }
  }

  std::unique_ptr<RunReader> reader_;
  std::unique_ptr<PlayFrames> maker_;
};

TEST_F(PlayerFramesTest, HasWhatWasRecorded) {
  Write({});
  const auto frame = maker_->Make(9);
  ASSERT_NE(frame, nullptr) << reader_->error();
  const FramePtr run = sample_.FrameAt(9);
  EXPECT_EQ(frame->step, 9u);
  EXPECT_EQ(frame->time, run->time);
  EXPECT_EQ(frame->step_length, SampleRun::kStep);
  EXPECT_EQ(frame->seed, 7u);
  EXPECT_EQ(StateHash(*frame), StateHash(*run));
  EXPECT_EQ(frame->scene->scenario, sample_.scenario());
  for (std::size_t i = 0; i < run->bodies.size(); ++i) {
    EXPECT_LT((frame->bodies[i].p_WB - run->bodies[i].p_WB).norm(), 2e-6);
    EXPECT_LT(frame->bodies[i].orientation().angularDistance(run->bodies[i].orientation()), 3e-6);
  }
  EXPECT_NEAR(AnglesOf(*frame, 0)[1], 1.8, 1e-5);
  EXPECT_EQ(SpeedsOf(*frame, 0)[1], 20);
}

TEST_F(PlayerFramesTest, ARobotThatGoesTakesItsInputsAndNoOthers) {
  const auto scenario = std::make_shared<Scenario>(*sample_.scenario());
  for (RobotEntry& robot : scenario->robots) {
    const auto model = std::make_shared<RobotModel>(*robot.model);
    model->sensors.push_back(
        {.name = "radio", .kind = NeighboursModel{.message_range_m = 9, .delay_steps = 4}});
    robot.model = model;
  }
  const std::shared_ptr<const Scene> begin = MakeScene(scenario);
  WorldChange change;
  change.gone_robots = {begin->robots[0].id};
  std::string refusal;
  const std::shared_ptr<const Scene> rest = ChangedScene(*begin, change, refusal);
  ASSERT_NE(rest, nullptr) << refusal;

  const auto frame = [](const Frame& like, const std::shared_ptr<const Scene>& scene, std::uint64_t step) {
    const std::shared_ptr<Frame> made = InScene(like, scene);
    made->step = step;
    made->time = static_cast<Nanoseconds>(step) * SampleRun::kStep;
    made->messages.clear();
    std::ranges::fill(made->commanded, 0);
    return made;
  };
  const std::shared_ptr<Frame> first = frame(*sample_.FrameAt(0), begin, 0);
  const std::shared_ptr<Frame> told = frame(*first, begin, 1);
  SetSetpoint(*told, 0, {0.1, 0.2});
  SetSetpoint(*told, 1, {0.3, 0.4});
  std::ranges::fill(told->commanded, 1);
  for (const std::uint32_t robot : {0U, 1U}) told->messages.push_back({robot, 1, {1, {10.0 + robot}}});
  const std::shared_ptr<Frame> after = frame(*told, rest, 2);
  SavedState state;
  state.frame = first;
  RunWriterOptions options;
  options.header = HeaderOf(*first, Mode::kLockstep, {true, true, true, true}, 0);
  std::string error;
  const auto writer = RunWriter::Create(file_, options, state, error);
  ASSERT_NE(writer, nullptr) << error;
  writer->AddStep(*told);
  writer->AddStep(*after);
  EXPECT_TRUE(writer->Close(error)) << writer->error();

  reader_ = RunReader::Open(file_, error);
  ASSERT_NE(reader_, nullptr) << error;
  reader_->UseScenario(scenario);
  maker_ = std::make_unique<PlayFrames>(*reader_);
  const auto shown = maker_->Make(2);
  ASSERT_NE(shown, nullptr) << reader_->error();
  ASSERT_EQ(shown->scene->robots.size(), 1u);
  EXPECT_EQ(SetpointOf(*shown, 0), SetpointOf(*told, 1));
  ASSERT_EQ(shown->messages.size(), 1u);
  EXPECT_EQ(shown->messages[0].robot, 0u);
  EXPECT_EQ(shown->messages[0].message.values[0], 11) << "what robot 2 sent";
  // Back again, and forth.
  EXPECT_EQ(maker_->Make(1)->messages.size(), 2u);
  EXPECT_EQ(SetpointOf(*maker_->Make(2), 0), SetpointOf(*told, 1));
}

TEST_F(PlayerFramesTest, ChannelsThatWereNotRecordedAreNoNumbers) {
  Write({.channels = false});
  for (const std::uint64_t step : {0, 9}) {
    const auto frame = maker_->Make(step);
    ASSERT_NE(frame, nullptr) << reader_->error();
    for (const ChannelState& channel : frame->channels) {
      EXPECT_TRUE(std::isnan(channel.position));
      EXPECT_TRUE(std::isnan(channel.velocity));
    }
  }
}

TEST_F(PlayerFramesTest, VelocitiesAreDifferencesOfPoses) {
  Write({});
  const auto frame = maker_->Make(9);
  for (std::size_t i = 0; i < frame->bodies.size(); ++i) {
    EXPECT_NEAR(frame->bodies[i].v_WB.x(), 0.2 * static_cast<double>(i + 1), 2e-4);
    EXPECT_NEAR(frame->bodies[i].v_WB.y(), 0, 2e-4);
    EXPECT_NEAR(frame->bodies[i].w_WB.z(), 0.5, 1e-3);
    EXPECT_NEAR(frame->bodies[i].w_WB.x(), 0, 1e-3);
  }
}

TEST_F(PlayerFramesTest, OfTheFirstStepTheyAreExact) {
  Write({});
  const auto frame = maker_->Make(0);
  EXPECT_EQ(frame->bodies[1].v_WB, Vector3(0.4, 0, 0));
  EXPECT_EQ(frame->bodies[1].w_WB, Vector3(0, 0, 0.5));
}

TEST_F(PlayerFramesTest, AcrossLostStepsVelocitiesAreTheirMean) {
  Write({.lost_from = 5, .lost_to = 9});
  const auto frame = maker_->Make(10);
  EXPECT_NEAR(frame->bodies[0].v_WB.x(), 0.2, 1e-4);
  EXPECT_NEAR(frame->bodies[0].w_WB.z(), 0.5, 1e-3);
}

TEST_F(PlayerFramesTest, AcrossStepsWithoutPosesTooAndTheStepLengthIsThatOfTheRun) {
  Write({.pose_every = 5 * SampleRun::kStep});
  const auto frame = maker_->Make(15);
  EXPECT_NEAR(frame->bodies[2].v_WB.x(), 0.6, 1e-4);
  EXPECT_EQ(frame->step_length, SampleRun::kStep);
}

TEST_F(PlayerFramesTest, InputsAreThoseOfTheRunForwards) {
  Write({.steps = 40});
  for (std::uint64_t step = 0; step <= 40; ++step) ExpectInputsOf(step, *maker_->Make(step));
}

TEST_F(PlayerFramesTest, InputsAreThoseOfTheRunBackwards) {
  Write({.steps = 40});
  for (std::uint64_t step = 40; step-- > 0;) ExpectInputsOf(step, *maker_->Make(step));
}

TEST_F(PlayerFramesTest, InputsAreThoseOfTheRunAfterJumps) {
  Write({.steps = 200, .keyframe_every = 50, .lost_from = 60, .lost_to = 63});
  std::uint64_t step = 17;
  for (int i = 0; i < 100; ++i, step = (step * 7 + 13) % 201) {
    if (step < 60 || step > 63) ExpectInputsOf(step, *maker_->Make(step));
  }
}

TEST_F(PlayerFramesTest, InputsHoldWithoutKeyframesForLong) {
  Write({.steps = 6000, .keyframe_every = 100'000});
  for (const std::uint64_t step : {5, 2500, 2501, 5999, 4000, 1, 6000}) {
    ExpectInputsOf(step, *maker_->Make(step));
  }
}

TEST(AngularVelocityTest, TurnsTheShortWay) {
  const Quaternion from(Eigen::AngleAxisd(3.0, Vector3::UnitZ()));
  const Quaternion to(Eigen::AngleAxisd(-3.0, Vector3::UnitZ()));
  EXPECT_NEAR(AngularVelocity(from, to, 0.1).z(), (2 * M_PI - 6) / 0.1, 1e-9);
  EXPECT_EQ(AngularVelocity(from, from, 0.1), Vector3::Zero());
}

TEST(AngularVelocityTest, IsInTheWorld) {
  const Quaternion from(Eigen::AngleAxisd(M_PI / 2, Vector3::UnitX()));
  const Quaternion to(Eigen::AngleAxisd(0.01, Vector3::UnitZ()) * from);
  const Vector3 w = AngularVelocity(from, to, 0.01);
  EXPECT_NEAR((w - Vector3::UnitZ()).norm(), 0, 1e-9);
}

}  // namespace
}  // namespace coopdyn

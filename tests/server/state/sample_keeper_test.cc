// SPDX-License-Identifier: MIT
#include "server/state/sample_keeper.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace coopdyn {
namespace {

/// Steps of a scene with one sensor with `timing`.
class SampledSteps {
 public:
  explicit SampledSteps(const SensorTiming& timing, Nanoseconds length = 10'000'000) : length_(length) {
    auto model = std::make_shared<RobotModel>();
    model->links.resize(1);
    model->links[0].mass_kg = 1;
    model->AddSensor("imu", ImuModel(), timing);
    auto scenario = std::make_shared<Scenario>();
    RobotEntry entry;
    entry.name = "robot1";
    entry.model = model;
    scenario->robots = {entry};
    scene_ = MakeScene(scenario);
  }

  /// The next frame of epoch `epoch`.
  Frame& Step() {
    frames_.push_back(std::make_unique<Frame>());
    Frame& frame = *frames_.back();
    frame.epoch = epoch_;
    frame.step = step_;
    frame.time = static_cast<Nanoseconds>(step_) * length_;
    frame.step_length = length_;
    frame.scene = scene_;
    keeper_.AddTo(frame);
    ++step_;
    return frame;
  }
  /// The steps whose samples are shown in the next `count` frames.
  std::vector<std::uint64_t> Shown(int count) {
    std::vector<std::uint64_t> steps;
    for (int i = 0; i < count; ++i) steps.push_back(SampleOf(Step(), 0, 0).step);
    return steps;
  }
  void Reset() {
    ++epoch_;
    step_ = 0;
  }
  SampleKeeper& keeper() { return keeper_; }

 private:
  const Nanoseconds length_;
  std::shared_ptr<const Scene> scene_;
  SampleKeeper keeper_;
  std::vector<std::unique_ptr<Frame>> frames_;
  std::uint64_t epoch_ = 1, step_ = 0;
};

using Steps = std::vector<std::uint64_t>;

TEST(SampleKeeperTest, ARateThatDividesTheStepsShowsEachSampleForItsPeriod) {
  EXPECT_EQ(SampledSteps({25, 0}).Shown(10), (Steps{0, 0, 0, 0, 4, 4, 4, 4, 8, 8}));
}

TEST(SampleKeeperTest, AnotherRateTakesEachSampleInTheFirstStepAtItsTime) {
  EXPECT_EQ(SampledSteps({30, 0}).Shown(12), (Steps{0, 0, 0, 0, 4, 4, 4, 7, 7, 7, 10, 10}));
}

TEST(SampleKeeperTest, ARateAboveThatOfTheStepsSamplesEachStep) {
  EXPECT_EQ(SampledSteps({400, 0}).Shown(4), (Steps{0, 1, 2, 3}));
}

TEST(SampleKeeperTest, ADelayShowsWhatWasSoLongAgo) {
  EXPECT_EQ(SampledSteps({0, 0.03}).Shown(7), (Steps{0, 0, 0, 0, 1, 2, 3}));
}

TEST(SampleKeeperTest, ADelayedSampleIsShownWhenItIsOldEnough) {
  EXPECT_EQ(SampledSteps({25, 0.05}).Shown(15), (Steps{0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 4, 4, 4, 8, 8}));
}

TEST(SampleKeeperTest, SixtyHertzHaveSixtySamplesASecondForHours) {
  const SensorTiming timing{60, 0};
  const Nanoseconds hour = 3600 * kNanosecondsPerSecond;
  EXPECT_EQ(SampleKeeper::SampleAt(timing, 10 * hour), 10 * 3600 * 60);
  EXPECT_EQ(SampleKeeper::SampleAt(timing, 10 * hour + 50'000'000), 10 * 3600 * 60 + 3);
}

TEST(SampleKeeperTest, AResetBeginsWithASample) {
  SampledSteps steps({10, 0});
  steps.Shown(15);
  steps.Reset();
  EXPECT_EQ(steps.Shown(3), (Steps{0, 0, 0}));
}

TEST(SampleKeeperTest, ItGoesOnFromAFrameAsIfItHadNotStopped) {
  SampledSteps steps({7, 0.13}), repeated({7, 0.13});
  Frame* saved = nullptr;
  for (int i = 0; i < 40; ++i) {
    saved = &steps.Step();
    repeated.Step();
  }
  repeated.keeper() = {};
  repeated.keeper().Continue(*saved, saved->epoch);
  EXPECT_EQ(repeated.Shown(60), steps.Shown(60));
}

TEST(SampleKeeperTest, WhatIsShownCanBeToldWithoutTheStepsBefore) {
  for (const SensorTiming& timing : {SensorTiming{25, 0}, SensorTiming{30, 0}, SensorTiming{7, 0.13},
                                     SensorTiming{0, 0.03}, SensorTiming{60, 0.033}, SensorTiming{0.5, 0}}) {
    for (const Nanoseconds length : {10'000'000, 4'000'000, 1'000'000}) {
      SampledSteps steps(timing, length);
      for (std::uint64_t step = 0; step < 600; ++step) {
        const std::uint64_t shown = SampleOf(steps.Step(), 0, 0).step;
        const Nanoseconds time = static_cast<Nanoseconds>(step) * length;
        EXPECT_EQ(step - SampleKeeper::StepsBack(timing, time, length), shown)
            << timing.rate_hz << " Hz, " << timing.delay_s << " s, step " << step;
      }
    }
  }
}

TEST(SampleKeeperTest, ASampleHasNoneOfItsOwn) {
  SampledSteps steps({10, 0});
  steps.Shown(5);
  const Frame& sample = SampleOf(steps.Step(), 0, 0);
  EXPECT_TRUE(sample.samples.empty());
  EXPECT_EQ(&SampleOf(sample, 0, 0), &sample);
}

TEST(SampleKeeperTest, FramesShareTheSampleThatTheyShow) {
  SampledSteps steps({10, 0});
  const Frame& a = steps.Step();
  const Frame& b = steps.Step();
  EXPECT_EQ(&SampleOf(a, 0, 0), &SampleOf(b, 0, 0));
}

}  // namespace
}  // namespace coopdyn

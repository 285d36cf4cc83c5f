// SPDX-License-Identifier: MIT
#include "server/web/sensor_feed.h"

#include <gtest/gtest.h>

#include <memory>

namespace coopdyn {
namespace {

FramePtr FrameOf(const std::shared_ptr<const Scene>& scene) {
  auto frame = std::make_shared<Frame>();
  frame->scene = scene;
  return frame;
}

class SensorFeedTest : public testing::Test {
 protected:
  ManualClock clock_;
  int made_ = 0;
  SensorFeed feed_{[this](const Frame&) {
    clock_.Advance(100);
    return std::to_string(++made_);
  }};
  std::shared_ptr<const Scene> scene_ = std::make_shared<Scene>();
};

TEST_F(SensorFeedTest, AFramesMessageIsMadeOnceForAllPages) {
  const FramePtr frame = FrameOf(scene_);
  const SensorFeed::Given one = feed_.Take(frame, clock_), other = feed_.Take(frame, clock_);
  EXPECT_EQ(one.message, other.message);
  EXPECT_EQ(other.wait, 0);
  EXPECT_EQ(made_, 1);
}

TEST_F(SensorFeedTest, TheNextIsMadeAfterFourTimesTheTimeThatTheLastTook) {
  const FramePtr first = FrameOf(scene_), second = FrameOf(scene_);
  feed_.Take(first, clock_);
  clock_.Advance(399);
  const SensorFeed::Given early = feed_.Take(second, clock_);
  EXPECT_EQ(*early.message, "1");
  EXPECT_EQ(early.wait, 1);
  clock_.Advance(1);
  const SensorFeed::Given late = feed_.Take(second, clock_);
  EXPECT_EQ(*late.message, "2");
  EXPECT_EQ(late.wait, 0);
}

TEST_F(SensorFeedTest, AnotherSceneDoesNotShowTheSensorsOfTheLast) {
  const FramePtr first = FrameOf(scene_), second = FrameOf(std::make_shared<Scene>());
  feed_.Take(first, clock_);
  EXPECT_EQ(*feed_.Take(second, clock_).message, "2");
}

}  // namespace
}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/state/frame_pool.h"

#include <gtest/gtest.h>

#include <thread>

namespace coopdyn {
namespace {

TEST(FramePoolTest, GivesTheBuffersOfADroppedFrameAgain) {
  FramePool pool;
  auto frame = pool.Take();
  frame->bodies.resize(1000);
  const BodyState* const buffer = frame->bodies.data();
  frame.reset();
  frame = pool.Take();
  frame->bodies.resize(1000);
  EXPECT_EQ(frame->bodies.data(), buffer);
}

TEST(FramePoolTest, GivesEmptyFrames) {
  FramePool pool;
  auto frame = pool.Take();
  frame->step = 7;
  frame->bodies.resize(3);
  frame->channels.resize(2);
  frame->commanded.resize(1);
  frame->messages.resize(1);
  frame.reset();
  frame = pool.Take();
  EXPECT_EQ(frame->step, 0u);
  EXPECT_TRUE(frame->bodies.empty());
  EXPECT_TRUE(frame->channels.empty());
  EXPECT_TRUE(frame->commanded.empty());
  EXPECT_TRUE(frame->messages.empty());
}

TEST(FramePoolTest, LeavesAFrameThatIsHeldAlone) {
  FramePool pool;
  auto held = pool.Take();
  held->bodies.resize(3);
  auto next = pool.Take();
  next->bodies.resize(3);
  EXPECT_NE(held->bodies.data(), next->bodies.data());
}

TEST(FramePoolTest, FramesMayOutliveIt) {
  std::shared_ptr<Frame> frame;
  {
    FramePool pool;
    frame = pool.Take();
  }
  frame->bodies.resize(3);
  EXPECT_EQ(frame->bodies.size(), 3u);
}

TEST(FramePoolTest, TakesFramesBackFromOtherThreads) {
  FramePool pool;
  for (int i = 0; i < 100; ++i) {
    auto frame = pool.Take();
    frame->bodies.resize(10);
    std::jthread reader([held = FramePtr(std::move(frame))] { EXPECT_EQ(held->bodies.size(), 10u); });
  }
}

}  // namespace
}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/web/frame_cadence.h"

#include <gtest/gtest.h>

#include "tests/server/sensing/sample_frame.h"

namespace coopdyn {
namespace {

TEST(FrameCadenceTest, ARateNearZeroIsAVeryLongPeriod) {
  boost::asio::io_context context;
  int due = 0;
  FrameCadence cadence(context, [&due] { ++due; });
  for (const double rate_hz : {1e-10, 1e-300, 5e-324}) {
    cadence.Set(rate_hz);
    for (int i = 0; i < 10; ++i) context.poll();
  }
  EXPECT_EQ(due, 3);
}

TEST(FrameCadenceTest, APostponedFrameIsTakenLater) {
  boost::asio::io_context context;
  FrameBoard frames;
  frames.Publish(SampleWorld().Robot(At(0, 0)).MakeFrame());
  int due = 0;
  FrameCadence cadence(context, [&due] { ++due; });
  cadence.Set(1000);
  const FramePtr frame = cadence.Take(frames);
  cadence.Postpone(std::chrono::milliseconds(2));
  EXPECT_EQ(cadence.Take(frames), nullptr);
  while (due == 1) context.run_one();  // also runs the wait that Postpone() has ended
  EXPECT_EQ(cadence.Take(frames), frame);
}

}  // namespace
}  // namespace coopdyn

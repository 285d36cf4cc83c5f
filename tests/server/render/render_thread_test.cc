// SPDX-License-Identifier: MIT
#include "server/render/render_thread.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/server/sensing/sample_frame.h"

namespace coopdyn {
namespace {

ImageRequest Small(bool paced = false) {
  ImageRequest request;
  request.width = request.height = 64;
  request.paced = paced;
  return request;
}

class RenderThreadTest : public testing::Test {
 protected:
  std::future<ImageResult> Ask(const ImageRequest& request) {
    auto promise = std::make_shared<std::promise<ImageResult>>();
    images_.Request(request, [promise](const ImageResult& result) { promise->set_value(result); });
    return promise->get_future();
  }
  void Publish(std::uint64_t step) {
    auto frame = SampleWorld().Robot(At(0, 0)).MakeFrame();
    frame->step = step;
    frames_.Publish(FramePtr(std::move(frame)));
  }

  ImageBoard images_;
  FrameBoard frames_;
  ManualClock clock_;
};

TEST_F(RenderThreadTest, ASinglePictureIsMadeOfTheNewestFrame) {
  Publish(1);
  Publish(2);
  RenderThread render(images_, frames_, clock_, {}, NullLogger());
  const ImageResult result = Ask(Small()).get();
  EXPECT_EQ(result.error, "");
  EXPECT_EQ(result.step, 2U);
  ASSERT_TRUE(result.bytes);
  EXPECT_EQ((*result.bytes)[1], 'P');  // of PNG
}

TEST_F(RenderThreadTest, BeforeTheFirstFrameThereIsAClearError) {
  RenderThread render(images_, frames_, clock_, {}, NullLogger());
  EXPECT_EQ(Ask(Small()).get().error, "the world is not there yet: ask again in a moment");
  Publish(1);
  EXPECT_EQ(Ask(Small()).get().error, "");
}

TEST_F(RenderThreadTest, WhatThrowsEndsThePicturesAndIsTold) {
  Publish(1);
  std::promise<std::string> told;
  RenderOptions options;
  options.on_failure = [&told](const std::string& text) { told.set_value(text); };
  images_.Request(Small(), [](const ImageResult&) { throw std::runtime_error("no more memory"); });
  std::future<ImageResult> with_it = Ask(Small());
  RenderThread render(images_, frames_, clock_, options, NullLogger());
  EXPECT_THAT(with_it.get().error, testing::HasSubstr("drawing has failed"));
  EXPECT_THAT(told.get_future().get(), testing::HasSubstr("drawing has failed: no more memory. Start"));
  EXPECT_THAT(Ask(Small()).get().error, testing::HasSubstr("drawing has failed: no more memory"));
}

TEST_F(RenderThreadTest, AStreamIsPacedByTheClockAndSinglePicturesAreNot) {
  Publish(1);
  RenderThread render(images_, frames_, clock_, {RendererKind::kAuto, 50}, NullLogger());
  EXPECT_EQ(Ask(Small(true)).get().error, "");
  std::future<ImageResult> next = Ask(Small(true));
  EXPECT_EQ(Ask(Small()).get().step, 1U);  // requested later
  EXPECT_EQ(next.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
  Publish(2);
  clock_.Advance(kNanosecondsPerSecond / 50);
  EXPECT_EQ(next.get().step, 2U);
}

TEST_F(RenderThreadTest, AllStreamsShareATick) {
  Publish(1);
  std::vector<std::future<ImageResult>> viewers;
  for (int i = 0; i < 3; ++i) viewers.push_back(Ask(Small(true)));
  RenderThread render(images_, frames_, clock_, {RendererKind::kAuto, 50}, NullLogger());
  const auto bytes = viewers[0].get().bytes;
  EXPECT_EQ(viewers[1].get().bytes, bytes);  // the same picture, not drawn again
  EXPECT_EQ(viewers[2].get().bytes, bytes);
}

TEST_F(RenderThreadTest, StopRefusesWhatWaitsAndWhatComes) {
  Publish(1);
  RenderThread render(images_, frames_, clock_, {RendererKind::kAuto, 50}, NullLogger());
  EXPECT_EQ(Ask(Small(true)).get().error, "");
  std::future<ImageResult> waiting = Ask(Small(true));  // the clock stands still
  render.Stop();
  EXPECT_EQ(waiting.get().error, "the simulator is stopping");
  EXPECT_EQ(Ask(Small()).get().error, "the simulator is stopping");
}

TEST_F(RenderThreadTest, NobodyAsksAndItStopsWithoutEverDrawing) {
  RenderThread render(images_, frames_, clock_, {}, NullLogger());
  render.Stop();
}

}  // namespace
}  // namespace coopdyn

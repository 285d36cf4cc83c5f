// SPDX-License-Identifier: MIT
#include "server/state/image_board.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <thread>
#include <vector>

namespace coopdyn {
namespace {

ImageRequest Sized(int width, int height) {
  ImageRequest request;
  request.width = width;
  request.height = height;
  return request;
}

ImageRequest Paced() {
  ImageRequest request;
  request.paced = true;
  return request;
}

TEST(ImageBoardTest, SizesHaveLimits) {
  EXPECT_EQ(CheckImageRequest(Sized(kMinImagePixels, kMinImagePixels)), "");
  EXPECT_EQ(CheckImageRequest(Sized(kMaxImageWidth, kMaxImageHeight)), "");
  EXPECT_EQ(CheckImageRequest(Sized(15, 100)), "the width 15 is not possible: write 16 to 1920 pixels");
  EXPECT_NE(CheckImageRequest(Sized(1921, 100)), "");
  EXPECT_EQ(CheckImageRequest(Sized(100, 1081)), "the height 1081 is not possible: write 16 to 1080 pixels");
  EXPECT_NE(CheckImageRequest(Sized(100, -5)), "");
}

TEST(ImageBoardTest, CamerasMustBeFiniteAndLookSomewhere) {
  ImageRequest request;
  request.eye_m = Vector3(1, std::numeric_limits<double>::quiet_NaN(), 0);
  EXPECT_NE(CheckImageRequest(request), "");
  request.eye_m = Vector3(1, 1e9, 0);
  EXPECT_NE(CheckImageRequest(request), "");
  request.eye_m = request.look_m = Vector3(1, 2, 3);
  EXPECT_NE(CheckImageRequest(request), "");
  request.eye_m = Vector3(1, 2, 4);
  EXPECT_EQ(CheckImageRequest(request), "");
}

TEST(ImageBoardTest, ABadRequestIsRefusedAtOnce) {
  ImageBoard board;
  std::string error;
  board.Request(Sized(5, 5), [&](const ImageResult& result) { error = result.error; });
  EXPECT_NE(error.find("width 5"), std::string::npos);
}

TEST(ImageBoardTest, RequestsAreTakenInTheOrderOfArrival) {
  ImageBoard board;
  const ManualClock clock;
  board.Request(Sized(100, 100), [](const ImageResult&) {});
  board.Request(Sized(200, 100), [](const ImageResult&) {});
  const auto taken = board.WaitAndTake({}, clock, 0);
  ASSERT_EQ(taken.size(), 2U);
  EXPECT_EQ(taken[0].request.width, 100);
  EXPECT_EQ(taken[1].request.width, 200);
}

TEST(ImageBoardTest, StreamsWaitForTheirTickAndSinglePicturesDoNot) {
  ImageBoard board;
  ManualClock clock;
  board.Request(Paced(), [](const ImageResult&) {});
  board.Request(Sized(100, 100), [](const ImageResult&) {});
  board.Request(Paced(), [](const ImageResult&) {});
  const auto early = board.WaitAndTake({}, clock, 10);
  ASSERT_EQ(early.size(), 1U);
  EXPECT_FALSE(early[0].request.paced);
  clock.Advance(10);
  EXPECT_EQ(board.WaitAndTake({}, clock, 10).size(), 2U);
}

TEST(ImageBoardTest, AWaitEndsWhenARequestComes) {
  ImageBoard board;
  const ManualClock clock;
  std::vector<ImageBoard::Pending> taken;
  std::jthread waiter([&](std::stop_token stop) { taken = board.WaitAndTake(stop, clock, 0); });
  board.Request({}, [](const ImageResult&) {});
  waiter.join();
  EXPECT_EQ(taken.size(), 1U);
}

TEST(ImageBoardTest, AWaitEndsWhenItIsToldToStop) {
  ImageBoard board;
  const ManualClock clock;
  std::size_t taken = 99;
  {
    std::jthread waiter([&](std::stop_token stop) { taken = board.WaitAndTake(stop, clock, 0).size(); });
  }
  EXPECT_EQ(taken, 0U);
}

TEST(ImageBoardTest, WhenTooManyWaitTheOldestOfAStreamGivesWay) {
  ImageBoard board;
  std::vector<std::string> refused;
  const auto ask = [&](ImageRequest request, const std::string& name) {
    board.Request(request, [&refused, name](const ImageResult& result) {
      refused.push_back(name + ": " + result.error);
    });
  };
  for (std::size_t i = 0; i + 2 < ImageBoard::kMaxWaiting; ++i) ask({}, "single");
  ask(Paced(), "stream 1");
  ask(Paced(), "stream 2");
  EXPECT_TRUE(refused.empty());
  ask({}, "one more");
  ask({}, "another");
  ask({}, "too many");
  ASSERT_EQ(refused.size(), 3U);
  EXPECT_EQ(refused[0], "stream 1: too many pictures are asked for at once: ask again");
  EXPECT_EQ(refused[1].substr(0, 9), "stream 2:");
  EXPECT_EQ(refused[2].substr(0, 9), "too many:");
}

TEST(ImageBoardTest, AClosedBoardRefusesAllWithTheReason) {
  ImageBoard board;
  std::vector<std::string> errors;
  const auto note = [&](const ImageResult& result) { errors.push_back(result.error); };
  board.Request({}, note);
  board.Close("no pictures: started with --no-render");
  board.Request({}, note);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[0], "no pictures: started with --no-render");
  EXPECT_EQ(errors[1], errors[0]);
  EXPECT_TRUE(board.WaitAndTake({}, ManualClock(), 0).empty());
}

}  // namespace
}  // namespace coopdyn

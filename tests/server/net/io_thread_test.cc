// SPDX-License-Identifier: MIT
#include "server/net/io_thread.h"

#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <stdexcept>

#include "test_client.h"

namespace coopdyn {
namespace {

using std::chrono::microseconds;

class IoThreadTest : public ::testing::TestWithParam<int> {
 protected:
  IoThread thread_{"io-test", NullLogger(), microseconds(GetParam())};
};

INSTANTIATE_TEST_SUITE_P(SpinMicroseconds, IoThreadTest, ::testing::Values(0, 200));

TEST_P(IoThreadTest, RunsWhatIsPostedInOrderOnItsOwnThread) {
  std::promise<std::string> done;
  std::string order;
  thread_.Post([&] { order += thread_.is_current() ? "a" : "x"; });
  thread_.Post([&] { done.set_value(order + "b"); });
  EXPECT_EQ(done.get_future().get(), "ab");
  EXPECT_FALSE(thread_.is_current());
}

TEST_P(IoThreadTest, AnExceptionDoesNotEndTheLoop) {
  thread_.Post([] { throw std::runtime_error("posted"); });
  thread_.Post([] { throw 42; });
  bool ran = false;
  thread_.Call([&] { ran = true; });
  EXPECT_TRUE(ran);
}

TEST_P(IoThreadTest, CallHandsExceptionsToItsCaller) {
  EXPECT_THROW(thread_.Call([] { throw std::out_of_range("x"); }), std::out_of_range);
}

TEST_P(IoThreadTest, CallRunsOnTheCallersThreadAfterStop) {
  thread_.Stop();
  std::thread::id ran_on;
  thread_.Call([&] { ran_on = std::this_thread::get_id(); });
  EXPECT_EQ(ran_on, std::this_thread::get_id());
}

TEST_P(IoThreadTest, APosterThatOutlivesTheThreadDropsWhatItIsGiven) {
  auto short_lived = std::make_unique<IoThread>("io-gone", NullLogger(), microseconds(GetParam()));
  const IoThread::Poster poster = short_lived->poster();
  std::promise<void> ran;
  poster([&ran] { ran.set_value(); });
  ran.get_future().wait();
  short_lived.reset();
  const auto held = std::make_shared<int>(1);
  poster([held] { FAIL(); });
  EXPECT_EQ(held.use_count(), 1);
}

TEST_P(IoThreadTest, WhatIsHandedOverRunsOnTheCallersThreadWhileTheThreadRests) {
  const IoThread::Poster hand_over = thread_.hand_over();
  thread_.Call([] {});
  std::thread::id ran_on;
  ASSERT_TRUE(Eventually([&] {  // the thread may be on its way to rest
    hand_over([&] { ran_on = std::this_thread::get_id(); });
    thread_.Call([] {});
    return ran_on == std::this_thread::get_id();
  }));
}

TEST_P(IoThreadTest, WhatIsHandedOverWhileTheThreadWorksRunsThereLater) {
  const IoThread::Poster hand_over = thread_.hand_over();
  std::promise<void> working, may_end;
  thread_.Post([&] {
    working.set_value();
    may_end.get_future().wait();
  });
  working.get_future().wait();
  std::promise<bool> ran_there;
  hand_over([&] { ran_there.set_value(thread_.is_current()); });
  may_end.set_value();
  EXPECT_TRUE(ran_there.get_future().get());
}

TEST_P(IoThreadTest, WhatItHandsOverToItselfRunsAtOnce) {
  const IoThread::Poster hand_over = thread_.hand_over();
  std::string order;
  thread_.Call([&] {
    hand_over([&] { order += "first "; });
    order += "second";
  });
  EXPECT_EQ(order, "first second");
}

TEST_P(IoThreadTest, SpinCanBeChangedWhileItRuns) {
  for (const int spin_us : {100, 0, 50}) {
    thread_.SetSpin(microseconds(spin_us));
    int runs = 0;
    for (int i = 0; i < 10; ++i) thread_.Call([&] { ++runs; });
    EXPECT_EQ(runs, 10);
  }
}

}  // namespace
}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/timing/pace.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <thread>

namespace coopdyn {
namespace {

int Nice() {
  return getpriority(PRIO_PROCESS, 0);
}

/// Priorities are per thread: the test's stays unchanged.
template <typename Work>
void OnAThread(Work work) {
  std::thread(work).join();
}

TEST(UrgentThread, GoesFirstOrSaysThatItMayNot) {
  OnAThread([] {
    const int usual = Nice();
    UrgentThread thread;
    const bool allowed = thread.Set(true);
    EXPECT_EQ(Nice(), allowed ? std::min(usual, -10) : usual);
  });
}

TEST(UrgentThread, IsAsBeforeWhenItIsNotUrgentAnyMore) {
  OnAThread([] {
    const int usual = Nice();
    UrgentThread thread;
    thread.Set(true);
    thread.Set(false);
    EXPECT_EQ(Nice(), usual);
  });
}

TEST(UrgentThread, IsAsBeforeAtItsEnd) {
  OnAThread([] {
    const int usual = Nice();
    { UrgentThread().Set(true); }
    EXPECT_EQ(Nice(), usual);
  });
}

TEST(UrgentThread, OtherThreadsStayAsTheyAre) {
  const int usual = Nice();
  OnAThread([usual] {
    UrgentThread thread;
    thread.Set(true);
    EXPECT_EQ(getpriority(PRIO_PROCESS, static_cast<id_t>(::getpid())), usual);
  });
}

}  // namespace
}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/base/worker_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <set>
#include <thread>
#include <vector>

#include "server/base/mutex.h"

namespace coopdyn {
namespace {

class PoolOf : public testing::TestWithParam<int> {};

TEST_P(PoolOf, EveryItemIsWorkedOnExactlyOnce) {
  WorkerPool pool(GetParam());
  for (const std::size_t count : {0u, 1u, 7u, 64u, 1000u}) {
    for (const std::size_t grain : {1u, 3u, 64u, 5000u}) {
      std::vector<int> visits(count, 0);
      pool.For(count, grain, [&](std::size_t first, std::size_t end) {
        EXPECT_LT(first, end);
        EXPECT_LE(end - first, grain);
        for (std::size_t i = first; i < end; ++i) ++visits[i];
      });
      EXPECT_EQ(visits, std::vector<int>(count, 1)) << count << " by " << grain;
    }
  }
}

TEST_P(PoolOf, WhatOneLoopWroteTheNextOneReads) {
  WorkerPool pool(GetParam());
  std::vector<std::uint64_t> values(500, 1), sums(500);
  for (int round = 0; round < 200; ++round) {
    pool.For(values.size(), 7, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) sums[i] = values[i] + values[values.size() - 1 - i];
    });
    pool.For(values.size(), 11, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) values[i] = sums[i] % 1000003;
    });
  }
  std::uint64_t expected = 1;
  for (int round = 0; round < 200; ++round) expected = 2 * expected % 1000003;
  EXPECT_EQ(values, std::vector<std::uint64_t>(500, expected));
}

TEST_P(PoolOf, AGrainOfZeroCountsAsOne) {
  WorkerPool pool(GetParam());
  std::atomic<int> items{0};
  pool.For(10, 0, [&](std::size_t first, std::size_t end) { items += static_cast<int>(end - first); });
  EXPECT_EQ(items, 10);
}

INSTANTIATE_TEST_SUITE_P(Threads, PoolOf, testing::Values(0, 1, 2, 4, 9));

TEST(WorkerPool, SaysHowManyThreadsWork) {
  EXPECT_EQ(WorkerPool(0).threads(), 1);
  EXPECT_EQ(WorkerPool(1).threads(), 1);
  EXPECT_EQ(WorkerPool(3).threads(), 3);
}

TEST(WorkerPool, AllThreadsTakePart) {
  WorkerPool pool(3);
  Mutex mutex;
  std::set<std::thread::id> threads;
  std::atomic<int> inside{0};
  // Each part waits until all three have begun, so no thread can run two.
  pool.For(3, 1, [&](std::size_t, std::size_t) {
    ++inside;
    while (inside.load() < 3) std::this_thread::yield();
    const MutexLock lock(mutex);
    threads.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(threads.size(), 3u);
}

TEST(WorkerPool, WithoutHelpersEverythingRunsOnTheCaller) {
  WorkerPool pool(1);
  pool.For(100, 7, [caller = std::this_thread::get_id()](std::size_t, std::size_t) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
  });
}

TEST(WorkerPool, ComesAndGoesWithoutWork) {
  for (int round = 0; round < 50; ++round) {
    WorkerPool pool(4);
    if (round % 2 == 0) continue;
    std::atomic<std::size_t> sum{0};
    pool.For(20, 1, [&](std::size_t first, std::size_t) { sum += first; });
    EXPECT_EQ(sum, 190u);
  }
}

}  // namespace
}  // namespace coopdyn

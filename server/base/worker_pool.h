// SPDX-License-Identifier: MIT
// Threads that run a loop in parallel. A loop's results must not depend on which thread runs which part, so
// that any number of threads gives the same bits. One thread owns the pool and calls For().
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace coopdyn {

class WorkerPool {
 public:
  /// `threads` includes the caller of For(); at most 1: everything runs on the caller.
  explicit WorkerPool(int threads);
  /// Joins the threads.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  int threads() const { return static_cast<int>(workers_.size()) + 1; }

  /// Splits [0, count) into parts of `grain` items, calls work(first, end) for each on all threads, and
  /// returns when all are done. `work` must not throw or call For().
  void For(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& work);

 private:
  struct Loop {
    const std::function<void(std::size_t, std::size_t)>* work = nullptr;
    std::size_t count = 0, grain = 1;
  };
  void Work(const std::stop_token& stop);
  /// Runs parts until none are left.
  void TakeParts();

  Loop loop_;  // written by For() while no worker is in it
  std::atomic<std::size_t> next_{0};
  std::atomic<std::uint32_t> generation_{0};  // loops so far; workers wait for it to change
  std::atomic<int> busy_{0};                  // workers that have not finished the current loop
  std::vector<std::jthread> workers_;         // last member: joined first
};

}  // namespace coopdyn

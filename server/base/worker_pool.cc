// SPDX-License-Identifier: MIT
#include "server/base/worker_pool.h"

#include <algorithm>

namespace coopdyn {

namespace {

// Between two loops of a step, workers poll instead of sleeping: a wake-up costs tens of microseconds.
constexpr int kPolls = 2000;

template <typename Value>
void WaitWhile(const std::atomic<Value>& value, Value old) {
  for (int i = 0; i < kPolls; ++i) {
    if (value.load(std::memory_order_acquire) != old) return;
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }
  value.wait(old, std::memory_order_acquire);
}

}  // namespace

WorkerPool::WorkerPool(int threads) {
  for (int i = 1; i < threads; ++i) {
    workers_.emplace_back([this](const std::stop_token& stop) { Work(stop); });
  }
}

WorkerPool::~WorkerPool() {
  for (std::jthread& worker : workers_) worker.request_stop();
  generation_.fetch_add(1, std::memory_order_release);
  generation_.notify_all();
}

void WorkerPool::For(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& work) {
  grain = std::max<std::size_t>(grain, 1);
  if (workers_.empty() || count <= grain) {
    for (std::size_t first = 0; first < count; first += grain) work(first, std::min(count, first + grain));
    return;
  }
  loop_ = {&work, count, grain};
  next_.store(0, std::memory_order_relaxed);
  busy_.store(static_cast<int>(workers_.size()), std::memory_order_relaxed);
  generation_.fetch_add(1, std::memory_order_release);
  generation_.notify_all();
  TakeParts();
  for (int busy = busy_.load(std::memory_order_acquire); busy > 0;
       busy = busy_.load(std::memory_order_acquire)) {
    WaitWhile(busy_, busy);
  }
}

void WorkerPool::Work(const std::stop_token& stop) {
  std::uint32_t seen = 0;
  while (true) {
    WaitWhile(generation_, seen);
    if (stop.stop_requested()) return;
    ++seen;
    TakeParts();
    if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) busy_.notify_one();
  }
}

void WorkerPool::TakeParts() {
  const Loop loop = loop_;
  for (std::size_t first = next_.fetch_add(loop.grain, std::memory_order_relaxed); first < loop.count;
       first = next_.fetch_add(loop.grain, std::memory_order_relaxed)) {
    (*loop.work)(first, std::min(loop.count, first + loop.grain));
  }
}

}  // namespace coopdyn

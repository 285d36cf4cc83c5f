// SPDX-License-Identifier: MIT
// A thread that runs one Asio io_context, optionally polling for a while before it blocks: on an idle machine
// a wake-up costs 80 us, a poll 1 us.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "server/base/log.h"

namespace boost::asio {
class io_context;
}

namespace coopdyn {

/// Thread-safe unless a member says otherwise. Exceptions of posted work are logged; the loop continues.
class IoThread {
 public:
  /// Starts the thread. `name` is shown by `ps -L` (its first 15 characters). `spin`: how long the thread
  /// polls after the last activity before it blocks.
  IoThread(std::string name, Logger logger, std::chrono::microseconds spin = std::chrono::microseconds{0});
  /// Calls Stop(). Users of context() must be destroyed first.
  ~IoThread();
  IoThread(const IoThread&) = delete;
  IoThread& operator=(const IoThread&) = delete;

  boost::asio::io_context& context() { return *context_; }
  const std::string& name() const { return name_; }
  /// True on the thread itself.
  bool is_current() const { return std::this_thread::get_id() == thread_id_.load(std::memory_order_relaxed); }
  /// Runs `work` on the thread, later, in its Turn. Work posted after Stop() never runs.
  void Post(std::function<void()> work);
  /// Post() for callers that may outlive the thread: then does nothing.
  using Poster = std::function<void(std::function<void()>)>;
  Poster poster() const;
  /// Like poster(), but if the thread sleeps, runs the work at once on the calling thread: no wake-up.
  Poster hand_over() const;
  /// Runs `work` on the thread and waits for it to finish; runs it on the caller's thread if this thread has
  /// stopped. Rethrows exceptions of `work`. Never call it holding a lock that `work` or the thread may want.
  void Call(const std::function<void()>& work);
  void SetSpin(std::chrono::microseconds spin);
  /// Ends the loop after the current handler and joins the thread (on the thread itself: only ends the loop).
  void Stop();

 private:
  void Run();

  const std::string name_;
  const Logger logger_;
  const std::shared_ptr<boost::asio::io_context> context_;  // shared only while a caller posts
  std::atomic<std::int64_t> spin_ns_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> ended_{false};          // the loop runs no more handlers
  std::atomic<std::thread::id> thread_id_;  // set by the thread itself
  std::jthread thread_;                     // last: starts after all other members exist
};

}  // namespace coopdyn

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

/// All members from any thread unless they say otherwise. Exceptions of what runs here are logged; the loop
/// goes on.
class IoThread {
 public:
  /// Starts the thread. `name` is what `ps -L` shows (15 characters of it). `spin`: how long after the last
  /// activity it polls before it blocks.
  IoThread(std::string name, Logger logger, std::chrono::microseconds spin = std::chrono::microseconds{0});
  /// Stop(). What uses context() must be gone before.
  ~IoThread();
  IoThread(const IoThread&) = delete;
  IoThread& operator=(const IoThread&) = delete;

  boost::asio::io_context& context() { return *context_; }
  const std::string& name() const { return name_; }
  /// True on the thread itself.
  bool is_current() const { return std::this_thread::get_id() == thread_id_.load(std::memory_order_relaxed); }
  /// Runs `work` on the thread, later, in its Turn; never after Stop().
  void Post(std::function<void()> work);
  /// Post() for those who may outlive the thread: then it does nothing.
  using Poster = std::function<void(std::function<void()>)>;
  Poster poster() const;
  /// As poster(), but runs the work at once, on the calling thread, if the thread rests: no wake-up.
  Poster hand_over() const;
  /// Runs `work` on the thread and waits for its end; on the caller's if the thread has stopped. What `work`
  /// throws is thrown here. Never call it holding a lock that `work` or the thread may want.
  void Call(const std::function<void()>& work);
  void SetSpin(std::chrono::microseconds spin);
  /// Ends the loop after what runs now and joins the thread (on the thread itself: only ends the loop).
  void Stop();

 private:
  void Run();

  const std::string name_;
  const Logger logger_;
  const std::shared_ptr<boost::asio::io_context> context_;  // others hold it only while they post
  std::atomic<std::int64_t> spin_ns_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> ended_{false};          // the loop runs nothing any more
  std::atomic<std::thread::id> thread_id_;  // set by the thread itself
  std::jthread thread_;                     // last: started when the rest is there
};

}  // namespace coopdyn

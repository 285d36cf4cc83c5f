// SPDX-License-Identifier: MIT
// The right to use the objects of an io_context's handlers. The context's thread takes the turn for each
// handler. While that thread sleeps, another thread may try to take the turn and do the work at once instead
// of waking it.
#pragma once

#include <mutex>
#include <utility>

#include <boost/asio/execution_context.hpp>
#include <boost/asio/io_context.hpp>

namespace coopdyn {

/// A service of its io_context. As with the baton (server/physics/stepper.h), other threads only try to take
/// the turn; the context's own thread waits for it. Recursive.
class Turn final : public boost::asio::execution_context::service {
 public:
  using key_type = Turn;
  static inline boost::asio::execution_context::id id;

  static Turn& Of(boost::asio::io_context& context) { return boost::asio::use_service<Turn>(context); }
  explicit Turn(boost::asio::execution_context& context) : service(context) {}

  /// Runs `work` in the turn. Only on the context's own thread.
  template <typename Work>
  void Run(Work&& work) {
    const std::lock_guard lock(mutex_);
    std::forward<Work>(work)();
  }
  /// Runs `work` in the turn on the calling thread if the turn is free; else returns false. Any thread.
  template <typename Work>
  bool TryRun(Work&& work) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock()) return false;
    std::forward<Work>(work)();
    return true;
  }

 private:
  void shutdown() override {}

  std::recursive_mutex mutex_;
};

}  // namespace coopdyn

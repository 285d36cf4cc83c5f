// SPDX-License-Identifier: MIT
// Delivers answers of other threads to the UI thread, or drops them once the UI has stopped.
#pragma once

#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>

#include "server/base/mutex.h"

namespace coopdyn {

template <class Answer>
class Answers {
 public:
  using Done = std::function<void(const Answer&)>;

  /// Calls `drop`, on any thread, with answers that come too late. `context` outlives this object.
  explicit Answers(
      boost::asio::io_context& context, Done drop = [](const Answer&) {})
      : drop_(drop), mailbox_(std::make_shared<Mailbox>(context, *this, std::move(drop))) {}
  /// Stop().
  ~Answers() { Stop(); }
  Answers(const Answers&) = delete;
  Answers& operator=(const Answers&) = delete;

  /// Returns a function that any thread may call once with the answer. The UI thread later passes the answer
  /// to `done`, unless Stop() comes first. UI thread.
  Done Expect(Done done) {
    const std::uint64_t ticket = ++last_ticket_;
    waiting_.emplace(ticket, std::move(done));
    return [mailbox = mailbox_, ticket](const Answer& answer) { mailbox->Post(ticket, answer); };
  }
  /// Drops all further answers. UI thread, or after that thread has stopped.
  void Stop() { mailbox_->Close(); }

 private:
  /// Posts answers to the UI thread; outlives it for late answers.
  class Mailbox {
   public:
    Mailbox(boost::asio::io_context& context, Answers& answers, Done drop)
        : context_(&context), answers_(answers), drop_(std::move(drop)) {}

    void Post(std::uint64_t ticket, const Answer& answer) EXCLUDES(mutex_) {
      MutexLock lock(mutex_);
      if (context_ == nullptr) return drop_(answer);
      boost::asio::post(*context_,
                        [&answers = answers_, ticket, answer] { answers.Deliver(ticket, answer); });
    }
    void Close() EXCLUDES(mutex_) {
      MutexLock lock(mutex_);
      context_ = nullptr;
    }

   private:
    Mutex mutex_;
    boost::asio::io_context* context_ GUARDED_BY(mutex_);
    Answers& answers_;
    const Done drop_;
  };

  void Deliver(std::uint64_t ticket, const Answer& answer) {
    auto found = waiting_.extract(ticket);
    if (!found) return drop_(answer);
    found.mapped()(answer);
  }

  const Done drop_;
  std::shared_ptr<Mailbox> mailbox_;
  // Kept here, not in the returned functions: the objects they hold must not outlive the UI thread's context.
  std::unordered_map<std::uint64_t, Done> waiting_;
  std::uint64_t last_ticket_ = 0;
};

}  // namespace coopdyn

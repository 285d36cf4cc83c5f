// SPDX-License-Identifier: MIT
#include "server/net/io_thread.h"

#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <exception>
#include <future>
#include <system_error>
#include <utility>
#include <vector>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "server/base/mutex.h"
#include "server/net/socket_poller.h"
#include "server/net/unique_fd.h"

namespace coopdyn {
namespace {

using std::chrono::steady_clock;

constexpr int kLooksAtSockets = 8;            // while polling, before timers and posted work have their turn
constexpr int kLooksAtPosted = 16;            // in a row: who posts a lot at once rings only once
constexpr std::size_t kThreadNameBytes = 15;  // the kernel's limit

}  // namespace

/// What waits for the thread, and the bell that wakes it. Whoever may post holds it, so that posting and
/// ringing are safe whatever becomes of the thread meanwhile. (io_context::post() wakes with its lock held,
/// at the cost of two more switches.)
class IoThread::Posted {
 public:
  Posted() : event_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    if (!event_) throw std::system_error(errno, std::generic_category(), "eventfd");
  }

  void Add(std::function<void()> work) {
    bool ring = false;
    {
      const MutexLock lock(mutex_);
      if (closed_) return;
      ring = !std::exchange(looks_, true);
      work_.push_back(std::move(work));
    }
    if (ring) Ring();
  }
  void Ring() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(event_.get(), &one, sizeof one);
  }
  /// Swaps the empty `work` for what has come; false: nothing, and the next to come rings.
  bool TakeInto(std::vector<std::function<void()>>& work) {
    const MutexLock lock(mutex_);
    work.swap(work_);
    return looks_ = !work.empty();
  }
  /// Drops what waits and what comes.
  void Close() {
    std::vector<std::function<void()>> dropped;  // freed outside the lock
    const MutexLock lock(mutex_);
    closed_ = true;
    dropped.swap(work_);
  }
  /// Readable after a ring.
  int event() const { return event_.get(); }

 private:
  const UniqueFd event_;
  Mutex mutex_;
  std::vector<std::function<void()>> work_ GUARDED_BY(mutex_);
  bool looks_ GUARDED_BY(mutex_) = false;  // the loop will look at work_ without another ring
  bool closed_ GUARDED_BY(mutex_) = false;
};

/// The loop's side of the bell.
struct IoThread::Wakeup {
  Wakeup(boost::asio::io_context& context, int fd) : event(context, fd) {}
  ~Wakeup() { event.release(); }  // others may still ring it

  boost::asio::posix::stream_descriptor event;
  std::uint64_t rings = 0;
};

IoThread::IoThread(std::string name, Logger logger, std::chrono::microseconds spin)
    : name_(std::move(name)),
      logger_(std::move(logger)),
      context_(std::make_unique<boost::asio::io_context>(1)),
      poller_(SocketPoller::Of(*context_)),
      posted_(std::make_shared<Posted>()),
      wakeup_(std::make_unique<Wakeup>(*context_, posted_->event())),
      spin_ns_(std::chrono::nanoseconds(spin).count()),
      thread_([this] { Run(); }) {}

IoThread::~IoThread() {
  Stop();
}

void IoThread::Post(std::function<void()> work) {
  posted_->Add(std::move(work));
}

IoThread::Poster IoThread::poster() const {
  return [posted = posted_](std::function<void()> work) { posted->Add(std::move(work)); };
}

void IoThread::RunPosted() {
  wakeup_->event.async_read_some(boost::asio::buffer(&wakeup_->rings, sizeof wakeup_->rings),
                                 [this](const boost::system::error_code& error, std::size_t) {
                                   if (!error) RunPosted();
                                 });
  std::vector<std::function<void()>> work;
  for (int i = 0; i < kLooksAtPosted; ++i) {
    work.clear();
    if (!posted_->TakeInto(work)) return;
    for (std::function<void()>& one : work) RunOne(one);
  }
  posted_->Ring();  // there may be more; sockets and timers have their turn first
}

void IoThread::RunOne(const std::function<void()>& work) {
  try {
    if (!stop_) work();
  } catch (const std::exception& error) {
    logger_->error("{}: {}", name_, error.what());
  } catch (...) {
    logger_->error("{}: an exception of unknown type", name_);
  }
}

void IoThread::Dispatch(std::function<void()> work) {
  if (is_current()) {
    work();
  } else {
    Post(std::move(work));
  }
}

void IoThread::Call(const std::function<void()>& work) {
  if (is_current()) return work();
  struct Job {
    std::atomic<bool> claimed{false};  // by the thread, or by the caller when the thread has ended
    std::promise<void> done;
  };
  auto job = std::make_shared<Job>();
  std::future<void> done = job->done.get_future();
  Post([job, &work] {
    if (job->claimed.exchange(true)) return;
    try {
      work();
      job->done.set_value();
    } catch (...) {
      job->done.set_exception(std::current_exception());
    }
  });
  while (done.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready) {
    if (ended_ && !job->claimed.exchange(true)) return work();
  }
  done.get();
}

void IoThread::SetSpin(std::chrono::microseconds spin) {
  spin_ns_ = std::chrono::nanoseconds(spin).count();
  Post([] {});  // wakes the loop
}

void IoThread::Stop() {
  stop_ = true;
  Post([] {});
  if (is_current()) return;
  if (thread_.joinable()) thread_.join();
  posted_->Close();
}

void IoThread::RunSome(steady_clock::time_point& active_at) {
  const std::chrono::nanoseconds spin{spin_ns_.load(std::memory_order_relaxed)};
  if (spin.count() > 0) {
    // A look at the sockets is one system call, one at everything two more.
    std::size_t handled = 0;
    for (int i = 0; i < kLooksAtSockets && handled == 0; ++i) handled = poller_.Poll();
    handled += context_->poll_one();
    const auto now = steady_clock::now();
    if (handled > 0) active_at = now;
    if (now - active_at < spin) return;
  }
  poller_.Arm();
  context_->run_one();
  active_at = steady_clock::now();
}

void IoThread::Run() {
  thread_id_ = std::this_thread::get_id();
  pthread_setname_np(pthread_self(), name_.substr(0, kThreadNameBytes).c_str());
  auto work_guard = boost::asio::make_work_guard(*context_);
  RunPosted();
  auto active_at = steady_clock::now();
  while (!stop_) {
    try {
      RunSome(active_at);
    } catch (const std::exception& error) {
      logger_->error("{}: {}", name_, error.what());
    } catch (...) {
      logger_->error("{}: an exception of unknown type", name_);
    }
  }
  ended_ = true;
}

}  // namespace coopdyn

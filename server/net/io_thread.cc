// SPDX-License-Identifier: MIT
#include "server/net/io_thread.h"

#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <exception>
#include <future>
#include <utility>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "server/net/socket_poller.h"

namespace coopdyn {
namespace {

using std::chrono::steady_clock;

constexpr int kLooksAtSockets = 8;            // while polling, before timers and posted work have their turn
constexpr int kLooksAtPosted = 16;            // in a row: who posts a lot at once rings only once
constexpr std::size_t kThreadNameBytes = 15;  // the kernel's limit

}  // namespace

/// An eventfd: written by whoever posts, read by the loop.
struct IoThread::Wakeup {
  explicit Wakeup(boost::asio::io_context& context)
      : event(context, ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

  void Ring() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(event.native_handle(), &one, sizeof one);
  }

  boost::asio::posix::stream_descriptor event;
  std::uint64_t rings = 0;
};

IoThread::IoThread(std::string name, Logger logger, std::chrono::microseconds spin)
    : name_(std::move(name)),
      logger_(std::move(logger)),
      context_(std::make_unique<boost::asio::io_context>(1)),
      poller_(SocketPoller::Of(*context_)),
      wakeup_(std::make_unique<Wakeup>(*context_)),
      spin_ns_(std::chrono::nanoseconds(spin).count()),
      thread_([this] { Run(); }) {}

IoThread::~IoThread() {
  Stop();
}

void IoThread::Post(std::function<void()> work) {
  bool ring = false;
  {
    const MutexLock lock(mutex_);
    ring = !std::exchange(looks_, true);
    posted_.push_back(std::move(work));
  }
  if (ring) wakeup_->Ring();
}

void IoThread::RunPosted() {
  wakeup_->event.async_read_some(boost::asio::buffer(&wakeup_->rings, sizeof wakeup_->rings),
                                 [this](const boost::system::error_code& error, std::size_t) {
                                   if (!error) RunPosted();
                                 });
  std::vector<std::function<void()>> work;
  for (int i = 0; i < kLooksAtPosted; ++i) {
    work.clear();
    {
      const MutexLock lock(mutex_);
      work.swap(posted_);
      looks_ = !work.empty();
      if (!looks_) return;
    }
    for (std::function<void()>& one : work) RunOne(one);
  }
  wakeup_->Ring();  // there may be more; sockets and timers have their turn first
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
  if (!is_current() && thread_.joinable()) thread_.join();
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

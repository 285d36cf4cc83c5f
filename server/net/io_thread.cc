// SPDX-License-Identifier: MIT
#include "server/net/io_thread.h"

#include <pthread.h>
#include <sys/resource.h>

#include <exception>
#include <future>
#include <utility>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "server/net/polling.h"
#include "server/net/turn.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;
using std::chrono::steady_clock;

constexpr std::size_t kThreadNameBytes = 15;  // the kernel's limit

/// Runs `work` and logs its exceptions.
template <typename Work>
void RunLogged(const Logger& logger, const std::string& name, Work&& work) {
  try {
    work();
  } catch (const std::exception& error) {
    logger->error("{}: {}", name, error.what());
  } catch (...) {
    logger->error("{}: an exception of unknown type", name);
  }
}

/// How often the kernel has preempted this thread.
std::int64_t CoreLosses() {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nivcsw;
}

void PostTo(asio::io_context& context, std::function<void()> work) {
  asio::post(context, [&turn = Turn::Of(context), work = std::move(work)] { turn.Run(work); });
}

}  // namespace

IoThread::IoThread(std::string name, Logger logger, std::chrono::microseconds spin)
    : name_(std::move(name)),
      logger_(std::move(logger)),
      context_(std::make_shared<asio::io_context>(1)),
      spin_ns_(std::chrono::nanoseconds(spin).count()),
      thread_([this] { Run(); }) {}

IoThread::~IoThread() {
  Stop();
}

void IoThread::Post(std::function<void()> work) {
  PostTo(*context_, std::move(work));
}

IoThread::Poster IoThread::poster() const {
  return [weak = std::weak_ptr(context_)](std::function<void()> work) {
    if (const auto context = weak.lock()) PostTo(*context, std::move(work));
  };
}

IoThread::Poster IoThread::hand_over() const {
  return [weak = std::weak_ptr(context_), &turn = Turn::Of(*context_), logger = logger_,
          name = name_](std::function<void()> work) {
    const auto context = weak.lock();
    if (context == nullptr) return;
    if (!turn.TryRun([&] { RunLogged(logger, name, work); })) PostTo(*context, std::move(work));
  };
}

void IoThread::Call(const std::function<void()>& work) {
  if (is_current()) return work();
  struct Job {
    std::atomic<bool> claimed{false};  // by the thread, or by the caller once the thread has ended
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
  context_->stop();
  if (!is_current() && thread_.joinable()) thread_.join();
}

void IoThread::Run() {
  thread_id_ = std::this_thread::get_id();
  pthread_setname_np(pthread_self(), name_.substr(0, kThreadNameBytes).c_str());
  const auto work_guard = asio::make_work_guard(*context_);
  Polling polling;
  while (!stop_) {
    RunLogged(logger_, name_, [&] {
      const std::chrono::nanoseconds spin{spin_ns_.load(std::memory_order_relaxed)};
      if (spin.count() <= 0) {
        context_->run_one();
        return;
      }
      const auto start = steady_clock::now();
      const bool polls = polling.Pays(start, spin);
      const bool ran = (polls ? context_->poll() : context_->run_one()) > 0;
      if (polls && !ran && polling.Yields(start, spin)) std::this_thread::yield();
      const auto now = steady_clock::now();
      if (ran) polling.NoteActivity(now);
      if (polls && now - start > Polling::kLongPoll) polling.NoteLongPoll(now, CoreLosses());
    });
  }
  ended_ = true;
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/base/log.h"

#include <spdlog/async.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/sinks/stdout_sinks.h>

namespace coopdyn {

namespace {
constexpr std::size_t kQueueLines = 8192;
constexpr std::size_t kMaxPeers = 4096;
}  // namespace

struct LogBackend::Impl {
  std::shared_ptr<spdlog::details::thread_pool> pool =
      std::make_shared<spdlog::details::thread_pool>(kQueueLines, std::size_t{1});
};

LogBackend::LogBackend(const std::string& level) : impl_(std::make_unique<Impl>()) {
  auto sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  logger_ = std::make_shared<spdlog::async_logger>("coopdyn", sink, impl_->pool,
                                                   spdlog::async_overflow_policy::overrun_oldest);
  logger_->set_pattern("%H:%M:%S.%e %l: %v");
  logger_->set_level(spdlog::level::from_str(level));
  logger_->flush_on(spdlog::level::warn);
}

LogBackend::~LogBackend() {
  const std::size_t dropped = impl_->pool->overrun_counter();
  if (dropped > 0) logger_->warn("{} log lines were dropped", dropped);
  logger_.reset();
  impl_.reset();
}

Logger NullLogger() {
  return std::make_shared<spdlog::logger>("null", std::make_shared<spdlog::sinks::null_sink_mt>());
}

bool PeerLogLimiter::Allow(const std::string& peer, Nanoseconds now, std::int64_t& suppressed) {
  const MutexLock lock(mutex_);
  if (windows_.size() > kMaxPeers) windows_.clear();
  Window& window = windows_[peer];
  if (window.lines == 0 || now - window.start >= kNanosecondsPerSecond) {
    window.start = now;
    window.lines = 0;
  }
  if (window.lines >= kLinesPerSecond) {
    ++window.suppressed;
    return false;
  }
  ++window.lines;
  suppressed = window.suppressed;
  window.suppressed = 0;
  return true;
}

}  // namespace coopdyn

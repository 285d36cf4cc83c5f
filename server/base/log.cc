// SPDX-License-Identifier: MIT
#include "server/base/log.h"

#include <spdlog/async.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/null_sink.h>
#include <cstdio>
#include <mutex>

#include "server/base/log_bar.h"
#include "server/base/printable.h"

namespace coopdyn {

namespace {
constexpr std::size_t kQueueLines = 8192;
constexpr std::size_t kMaxPeers = 4096;

/// Writes to stderr, whose last line may show a bar: log lines go above it.
class StderrSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  void ShowBar(const std::string& text) {
    const std::lock_guard lock(mutex_);
    const std::string before = bar_.empty() ? "" : kWipe;
    // Without the turn to the next line at the margin, so that one wipe is enough.
    bar_ = text.empty() ? "" : "\033[?7l" + text + "\033[?7h";
    Write(before + bar_);
  }

 private:
  static constexpr const char* kWipe = "\r\033[K";

  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string text = Printable({message.payload.data(), message.payload.size()});
    spdlog::details::log_msg shown = message;
    shown.payload = text;
    spdlog::memory_buf_t line;
    formatter_->format(shown, line);
    const std::string whole(line.data(), line.size());
    Write(bar_.empty() ? whole : kWipe + whole + bar_);
  }
  void flush_() override { std::fflush(stderr); }
  /// In one go: others write to stderr too.
  static void Write(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stderr); }

  std::string bar_;  // guarded by mutex_; empty: none
};
}  // namespace

struct LogBackend::Impl {
  std::shared_ptr<spdlog::details::thread_pool> pool =
      std::make_shared<spdlog::details::thread_pool>(kQueueLines, std::size_t{1});
};

LogBackend::LogBackend(const std::string& level) : impl_(std::make_unique<Impl>()) {
  auto sink = std::make_shared<StderrSink>();
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

void ShowBelowLog(const Logger& logger, const std::string& text) {
  for (const spdlog::sink_ptr& sink : logger->sinks()) {
    if (auto* terminal = dynamic_cast<StderrSink*>(sink.get())) terminal->ShowBar(text);
  }
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

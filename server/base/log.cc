// SPDX-License-Identifier: MIT
#include "server/base/log.h"

#include <fcntl.h>
#include <spdlog/async.h>
#include <spdlog/fmt/fmt.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/dist_sink.h>
#include <spdlog/sinks/null_sink.h>

#include <chrono>
#include <cstdio>
#include <mutex>

#include "server/base/printable.h"

namespace coopdyn {

namespace {
constexpr std::size_t kQueueLines = 8192;
constexpr std::size_t kMaxPeers = 4096;
constexpr std::chrono::minutes kCountEvery{1};

/// Passes on lines, made printable, and a run of equal lines once. Writes the number of repeats when a
/// different line follows, after a minute, and at the end.
class RepeatCounter final : public spdlog::sinks::dist_sink<std::mutex> {
 public:
  explicit RepeatCounter(std::vector<spdlog::sink_ptr> sinks) : dist_sink(std::move(sinks)) {}
  ~RepeatCounter() override {
    try {
      WriteCount();
    } catch (const std::exception&) {  // e.g. a full disk; no way to report it
    }
  }
  RepeatCounter(const RepeatCounter&) = delete;
  RepeatCounter& operator=(const RepeatCounter&) = delete;

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    std::string text = Printable({message.payload.data(), message.payload.size()});
    const bool again = text == text_ && message.level == level_;
    if (again) {
      ++repeated_;
      time_ = message.time;
    }
    if (!again || message.time - written_ >= kCountEvery) WriteCount();
    if (again) return;
    text_ = std::move(text);
    level_ = message.level;
    time_ = message.time;
    Write(text_);
  }

  void WriteCount() {
    const int repeated = std::exchange(repeated_, 0);
    if (repeated > 0) Write(repeated == 1 ? text_ : fmt::format("{} (repeated {} times)", text_, repeated));
  }

  void Write(const std::string& text) {
    written_ = time_;
    const spdlog::details::log_msg message(time_, {}, "coopdyn", level_, text);
    for (const spdlog::sink_ptr& sink : sinks_) {
      sink->log(message);
      sink->flush();
    }
  }

  // State of the last line; guarded by mutex_.
  std::string text_;
  spdlog::level::level_enum level_ = spdlog::level::off;
  spdlog::log_clock::time_point time_, written_;
  int repeated_ = 0;
};

/// Writes to stderr. The last line may show a bar; log lines go above it.
class StderrSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  void ShowBar(const std::string& text) {
    const std::lock_guard lock(mutex_);
    const std::string before = bar_.empty() ? "" : kWipe;
    // Auto-wrap off, so that wiping one line is enough.
    bar_ = text.empty() ? "" : "\033[?7l" + text + "\033[?7h";
    Write(before + bar_);
  }

 private:
  static constexpr const char* kWipe = "\r\033[K";

  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    const std::string whole(line.data(), line.size());
    Write(bar_.empty() ? whole : kWipe + whole + bar_);
  }
  void flush_() override { std::fflush(stderr); }
  /// One fwrite() per text: other code writes to stderr too.
  static void Write(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stderr); }

  std::string bar_;  // guarded by mutex_; empty: none
};
}  // namespace

struct LogBackend::Impl {
  std::shared_ptr<spdlog::details::thread_pool> pool =
      std::make_shared<spdlog::details::thread_pool>(kQueueLines, std::size_t{1});
};

LogBackend::LogBackend(const std::string& level, const std::string& file) : impl_(std::make_unique<Impl>()) {
  std::vector<spdlog::sink_ptr> sinks{std::make_shared<StderrSink>()};
  if (!file.empty()) {
    spdlog::file_event_handlers opened;
    opened.after_open = [](const std::string&, std::FILE* stream) {
      ::fcntl(::fileno(stream), F_SETFD, FD_CLOEXEC);
    };
    sinks.push_back(std::make_shared<spdlog::sinks::basic_file_sink_mt>(file, false, opened));
  }
  auto sink = std::make_shared<RepeatCounter>(std::move(sinks));
  logger_ = std::make_shared<spdlog::async_logger>("coopdyn", sink, impl_->pool,
                                                   spdlog::async_overflow_policy::overrun_oldest);
  logger_->set_pattern("%Y-%m-%d %H:%M:%S.%e%z %l: %v");
  logger_->set_level(spdlog::level::from_str(level));
  // Report e.g. a full disk once, not with every line.
  logger_->set_error_handler([said = false](const std::string& text) mutable {
    if (!std::exchange(said, true))
      std::fprintf(stderr, "coopdyn: the log is not complete: %s\n", text.c_str());
  });
}

LogBackend::~LogBackend() {
  const std::size_t dropped = impl_->pool->overrun_counter();
  if (dropped > 0) logger_->warn("{} log lines were dropped", dropped);
  impl_.reset();  // first: joins its thread, which releases the logger
  logger_.reset();
}

void ShowBelowLog(const Logger& logger, const std::string& text) {
  for (const spdlog::sink_ptr& sink : logger->sinks()) {
    auto* lines = dynamic_cast<RepeatCounter*>(sink.get());
    if (lines == nullptr) continue;
    for (const spdlog::sink_ptr& one : lines->sinks()) {
      if (auto* terminal = dynamic_cast<StderrSink*>(one.get())) terminal->ShowBar(text);
    }
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

// SPDX-License-Identifier: MIT
// Logging that never blocks: a bounded queue to one writer thread; a full queue drops and counts its oldest
// lines. A line begins with date, time and zone; a run of equal lines is written once, then its length. Any
// thread.
#pragma once

#include <spdlog/spdlog.h>

#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>

#include "server/base/clock.h"
#include "server/base/mutex.h"

namespace coopdyn {

using Logger = std::shared_ptr<spdlog::logger>;

/// A logger to stderr with its own queue and thread. `level`: trace, debug, info, warning, error, off.
/// `file`: also append lines to this file; empty: none. Throws spdlog::spdlog_ex if it cannot be opened.
/// The caller keeps `LogBackend` alive longer than every copy of the logger; its destructor flushes.
class LogBackend {
 public:
  explicit LogBackend(const std::string& level, const std::string& file = "");
  ~LogBackend();
  LogBackend(const LogBackend&) = delete;
  LogBackend& operator=(const LogBackend&) = delete;

  const Logger& logger() const { return logger_; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  Logger logger_;
};

/// Shows `text` below the lines that a `LogBackend`'s logger writes to stderr, which must be a terminal.
/// Replaces the previous text; empty: shows none. Text wider than the terminal is cut. Other loggers ignore
/// it.
void ShowBelowLog(const Logger& logger, const std::string& text);

/// A logger that writes nowhere, for tests.
Logger NullLogger();

/// Allows at most `kLinesPerSecond` lines a second per peer and counts the rest. Any thread.
class PeerLogLimiter {
 public:
  static constexpr int kLinesPerSecond = 10;
  /// True if a line about `peer` may be written at `now`. Sets `suppressed` to the number of suppressed lines
  /// since the last allowed one.
  bool Allow(const std::string& peer, Nanoseconds now, std::int64_t& suppressed);

 private:
  struct Window {
    Nanoseconds start = 0;
    int lines = 0;
    std::int64_t suppressed = 0;
  };
  Mutex mutex_;
  std::unordered_map<std::string, Window> windows_ GUARDED_BY(mutex_);
};

}  // namespace coopdyn

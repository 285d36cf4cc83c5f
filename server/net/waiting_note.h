// SPDX-License-Identifier: MIT
// Decides when `verbose` reports again whom a request waits for. Pure; one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

namespace coopdyn {

class WaitingNote {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::milliseconds kFirst{1000};  // wait before the first note
  static constexpr std::chrono::milliseconds kEach{250};    // delay of a note about a change
  static constexpr std::chrono::milliseconds kRepeat{2000};

  /// Time until the next check of request `serial`.
  std::chrono::milliseconds Pause(std::uint64_t serial) const { return serial == serial_ ? kEach : kFirst; }

  /// The `#` line to send about request `serial`, which waits for `whom` ("robot2 (no client), 1.2 s"); empty
  /// if it has been sent already. The text after the last ")" (the seconds) does not count as a change.
  std::string Line(std::uint64_t serial, const std::string& whom, TimePoint now) {
    const bool first = std::exchange(serial_, serial) != serial;
    std::string stable = whom.substr(0, whom.rfind("), "));
    if (whom.empty() || (!first && stable == reported_ && now - reported_at_ < kRepeat)) return {};
    reported_ = std::move(stable);
    reported_at_ = now;
    return (whom.starts_with("waiting for ") ? "# " : "# waiting for ") + whom + "\n";
  }

 private:
  std::uint64_t serial_ = 0;
  std::string reported_;
  TimePoint reported_at_{};
};

}  // namespace coopdyn

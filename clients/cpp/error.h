// SPDX-License-Identifier: MIT
// What the daemon refused, or what went wrong on the way to it.
#pragma once

#include <stdexcept>
#include <string>

namespace coopdyn::client {

/// Thrown by everything in this library. `code` is a number of the protocol (6: owned by another client, 10:
/// no such name, 11: timed out …) or kNoConnection; what() says what was wrong and what to do instead.
class Error : public std::runtime_error {
 public:
  static constexpr int kNoConnection = -1;

  Error(int code, const std::string& text) : std::runtime_error(text), code_(code) {}
  int code() const { return code_; }
  std::string text() const { return what(); }
  /// The word of the code, e.g. "owned".
  std::string name() const;

 private:
  int code_;
};

/// The daemon closed the connection; `notice` says why, if it said so.
class Closed : public Error {
 public:
  explicit Closed(const std::string& notice)
      : Error(kNoConnection,
              "the daemon closed the connection" + (notice.empty() ? std::string() : ": " + notice)),
        notice_(notice) {}
  const std::string& notice() const { return notice_; }

 private:
  std::string notice_;
};

}  // namespace coopdyn::client

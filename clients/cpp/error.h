// SPDX-License-Identifier: MIT
// What the daemon refused, or what went wrong on the way to it.
#pragma once

#include <stdexcept>
#include <string>

namespace coopdyn::client {

/// Error codes that this library acts on.
inline constexpr int kNotPossible = 5, kOwned = 6, kNoSuchName = 10, kTimedOut = 11;

/// Thrown by everything in this library. `code` is a number of the protocol (6: owned by another client, 10:
/// no such name, 11: timed out …) or kNoConnection; what() says what was wrong and what to do instead.
class Error : public std::runtime_error {
 public:
  static constexpr int kNoConnection = -1;

  Error(int code, const std::string& text) : std::runtime_error(text), code_(code) {}
  int code() const { return code_; }
  std::string text() const { return what(); }
  /// The word of the code, e.g. "owned".
  virtual std::string name() const;

 private:
  int code_;
};

/// Somebody else has reset the world or loaded a scenario. Thrown once, by the reading, command or step that
/// notices it. What was kept for the next step is forgotten; the simulation and those of its robots and teams
/// that are in the new world can be used again.
class WorldReset : public Error {
 public:
  explicit WorldReset(const std::string& text) : Error(5, text) {}
  std::string name() const override { return "reset"; }
};

/// The daemon closed the connection; `notice` says why, if it said so.
class Closed : public Error {
 public:
  Closed(const std::string& notice, const std::string& why_lost)
      : Error(kNoConnection,
              "the daemon closed the connection" + (notice.empty() ? "; " + why_lost : ": " + notice)),
        notice_(notice) {}
  const std::string& notice() const { return notice_; }
  /// A load has dropped the robot of the connection.
  bool by_load() const { return notice_.ends_with("is not in the new scenario"); }

 private:
  std::string notice_;
};

}  // namespace coopdyn::client

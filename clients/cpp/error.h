// SPDX-License-Identifier: MIT
// Errors of the daemon and of the connection to it.
#pragma once

#include <stdexcept>
#include <string>

namespace coopdyn::client {

/// Error codes that this library acts on.
inline constexpr int kNotPossible = 5, kOwned = 6, kNoSuchName = 10, kTimedOut = 11;

/// Any function of this library may throw it. `code` is a protocol error (6: owned by another client, 10: no
/// such name, 11: timed out …) or kNoConnection; what() says what is wrong and what to do instead.
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

/// Another client has reset the world or loaded a scenario. Thrown once, by the reading, command or step that
/// notices. Commands kept for the next step are discarded; the simulation, and its robots and teams that
/// exist in the new world, stay usable.
class WorldReset : public Error {
 public:
  explicit WorldReset(const std::string& text) : Error(5, text) {}
  std::string name() const override { return "reset"; }
};

/// The daemon closed the connection; `notice` is its reason, empty if it sent none.
class Closed : public Error {
 public:
  Closed(const std::string& notice, const std::string& why_lost)
      : Error(kNoConnection,
              "the daemon closed the connection" + (notice.empty() ? "; " + why_lost : ": " + notice)),
        notice_(notice) {}
  const std::string& notice() const { return notice_; }
  /// True if a load has removed the connection's robot.
  bool by_load() const { return notice_.ends_with("is not in the new scenario"); }

 private:
  std::string notice_;
};

}  // namespace coopdyn::client

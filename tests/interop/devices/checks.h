// SPDX-License-Identifier: MIT
// Shared by the checks: prints a line for each, and waits by the wall clock.
#pragma once

#include <yarp/os/Bottle.h>

#include <functional>
#include <span>
#include <string>

namespace coopdyn {

/// Prints `ok NAME` or `FAILED NAME: VALUE`, and counts. One thread.
class Checks {
 public:
  /// Returns `good`.
  bool That(const std::string& name, bool good, const std::string& got = "refused");
  /// Passes if the two differ by at most `within`.
  bool Near(const std::string& name, double value, double expected, double within);
  /// Passes if all values differ by at most `within` from the expected ones.
  bool AllNear(const std::string& name, std::span<const double> values, std::span<const double> expected,
               double within);
  /// Prints a measured value, which does not count as a check.
  static void Note(const std::string& text);
  /// Prints `N passed, N failed`; returns the exit code.
  int Finish() const;

 private:
  int passed_ = 0, failed_ = 0;
};

/// Formats values: 1.5 or (1.5 -0.25).
std::string Text(double value);
std::string Text(std::span<const double> values);

/// Waits until the condition holds; false after this number of seconds of wall time.
bool WaitFor(const std::function<bool()>& holds, double within_s = 10);
void Sleep(double wall_s);

/// The reply of /simulation to a line of the text form, which both versions read.
yarp::os::Bottle AskSimulation(const std::string& line);
/// Simulated time.
double SimulatedTime();

}  // namespace coopdyn

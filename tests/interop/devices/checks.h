// SPDX-License-Identifier: MIT
// What the checks have in common: a line for each, and waiting by the wall clock.
#pragma once

#include <yarp/os/Bottle.h>

#include <functional>
#include <span>
#include <string>

namespace coopdyn {

/// Prints `ok NAME` or `FAILED NAME: what it got`, and counts. One thread.
class Checks {
 public:
  /// Returns `good`.
  bool That(const std::string& name, bool good, const std::string& got = "refused");
  /// The two differ by at most `within`.
  bool Near(const std::string& name, double value, double expected, double within);
  /// All values differ by at most `within` from those expected.
  bool AllNear(const std::string& name, std::span<const double> values, std::span<const double> expected,
               double within);
  /// A measured value: a line that counts as nothing.
  static void Note(const std::string& text);
  /// Prints `N passed, N failed`; the exit code.
  int Finish() const;

 private:
  int passed_ = 0, failed_ = 0;
};

/// 1.5 or (1.5 -0.25).
std::string Text(double value);
std::string Text(std::span<const double> values);

/// Waits until it holds; false: not within so many seconds of the wall clock.
bool WaitFor(const std::function<bool()>& holds, double within_s = 10);
void Sleep(double wall_s);

/// What /simulation answers to a line of text; by text, as then both versions read it.
yarp::os::Bottle AskSimulation(const std::string& line);
/// Simulated time.
double SimulatedTime();

}  // namespace coopdyn

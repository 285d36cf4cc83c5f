// SPDX-License-Identifier: MIT
// Is a recorded run what it says? Repeats it from its inputs and compares the hash of every step.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "server/replay/state_at.h"

namespace coopdyn {

/// The first thing that differs.
struct Difference {
  std::uint64_t step = 0;  // the first one that is not equal
  Nanoseconds time = 0;    // of it
  std::string what;        // "robot1.chassis", "robot2"
  std::string field;       // "x_m", "setpoint_left_rad_s", …; `hash` if nothing that is recorded tells more
  std::string recorded, repeated;  // the values, exact as far as `exact`; 17 digits
  bool exact = true;               // false: the recorded one is a rounding (a pose between two keyframes)
  bool of_file = false;            // `what` is a row of the file that is not as it was written
  std::uint64_t value_step = 0;    // of the values; beyond `step`: the difference shows there first
  std::string note = {};           // for people, e.g. which commands came in force with this step; or empty
  std::string recorded_is = "recorded", repeated_is = "repeated";  // whose values they are: names of two runs
};

struct VerifyReport {
  std::string error;               // it could not be done: a damaged file, a scenario that does not load …
  std::uint64_t steps = 0;         // that are equal
  std::uint64_t not_verified = 0;  // that were lost, or are missing in a damaged file
  std::optional<Difference> difference;
  std::string
      warning;  // with a difference: another build, library or processor; controllers that were not found
};

/// Called now and then with the share done, 0…1.
using Progress = std::function<void(double)>;

/// Repeats the run of `reader`, whose scenario it loads.
VerifyReport Verify(RunReader& reader, const ReplayServices& services, const Progress& progress);
/// Compares the hashes of two runs over their common steps; where they part, repeats both from the last
/// common keyframe to say which body and field differ first, and by what. A file that was changed after it
/// was written is told of: as an error if the runs are equal otherwise, as a warning if they differ.
VerifyReport Compare(RunReader& one, RunReader& other, const ReplayServices& services,
                     const Progress& progress);
/// "equal, 1200 steps", or the difference, with the warning; lines.
std::string ToString(const VerifyReport& report);

}  // namespace coopdyn

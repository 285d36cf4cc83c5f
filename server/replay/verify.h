// SPDX-License-Identifier: MIT
// Verifies a recorded run: repeats it from its inputs and compares the hash of every step.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "server/replay/state_at.h"

namespace coopdyn {

/// The first thing that differs.
struct Difference {
  std::uint64_t step = 0;          // the first step that differs
  Nanoseconds time = 0;            // of `step`
  std::string what;                // "robot1.chassis", "robot2"
  std::string field;               // "x_m", "setpoint_left_rad_s", …; "hash" if the recording shows no more
  std::string recorded, repeated;  // the values, 17 digits
  bool exact = true;               // false: the recorded value is rounded (a pose between keyframes)
  bool of_file = false;            // `what` is a row of the file that was changed after it was written
  std::uint64_t value_step = 0;    // step of the values; after `step` if the difference shows only there
  std::string note = {};  // explanation, e.g. the commands that came into force with this step; or empty
  std::string recorded_is = "recorded", repeated_is = "repeated";  // labels, or names of two runs
};

struct VerifyReport {
  std::string error;        // why verification failed: a damaged file, a scenario that does not load …
  std::uint64_t steps = 0;  // equal steps
  std::uint64_t not_verified = 0;  // steps lost, or missing in a damaged file
  std::optional<Difference> difference;
  std::string warning;  // with a difference: another build, library or processor; missing controllers
};

/// Called periodically with the completed share, 0…1.
using Progress = std::function<void(double)>;

/// Loads the scenario of `reader` and repeats its run.
VerifyReport Verify(RunReader& reader, const ReplayServices& services, const Progress& progress);
/// Compares the hashes of two runs over their common steps. Where they diverge, repeats both from their last
/// keyframes to find the first body and field that differ, and their values. Reports a file that was changed
/// after it was written: as an error if the runs are otherwise equal, as a warning if they differ.
VerifyReport Compare(RunReader& one, RunReader& other, const ReplayServices& services,
                     const Progress& progress);
/// "equal, 1200 steps", or the difference, then the warning; several lines.
std::string ToString(const VerifyReport& report);

}  // namespace coopdyn

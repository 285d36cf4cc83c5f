// SPDX-License-Identifier: MIT
// How much room a recording takes. Pure functions, but for the look at the disk.
#pragma once

#include <cstddef>
#include <string>

#include "server/record/recorded_step.h"
#include "server/state/frame.h"

namespace coopdyn {

/// Bytes of a row of table `step` with poses and readings of `frame`, or without; not its commands and
/// messages, which nobody knows before.
std::size_t StepRowBytes(const Frame& frame, const RecordWhat& what, bool shown);
/// The page size of SQLite, 4096…65536, that suits rows of that many bytes.
std::size_t PageSizeFor(std::size_t row_bytes);

/// What recording will take, for the line at the start.
struct SpaceNeeded {
  double bytes_per_s = 0;   // of simulated time
  double bytes_in_all = 0;  // 0: the run has no end
  double bytes_free = 0;    // on the disk of the file
};
SpaceNeeded EstimateSpace(const Frame& frame, const RecordWhat& what, Nanoseconds pose_every,
                          double duration_s, const std::string& file);
/// "about 2.0 MB per simulated second, 58 GB for this run, 40 GB free"
std::string ToString(const SpaceNeeded& space);

}  // namespace coopdyn

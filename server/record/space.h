// SPDX-License-Identifier: MIT
// Estimates the disk space of a recording. Pure functions, except for the query of free space.
#pragma once

#include <cstddef>
#include <string>

#include "server/record/recorded_step.h"
#include "server/state/frame.h"

namespace coopdyn {

/// Bytes of a row of table `step` for `frame`; `shown`: with poses and readings. Excludes commands and
/// messages, which cannot be known in advance.
std::size_t StepRowBytes(const Frame& frame, const RecordWhat& what, bool shown);
/// The SQLite page size, 4096…65536, that suits rows of `row_bytes`.
std::size_t PageSizeFor(std::size_t row_bytes);

/// The space that a recording will need, for the line printed at the start.
struct SpaceNeeded {
  double bytes_per_s = 0;   // of simulated time
  double bytes_in_all = 0;  // 0: the run has no set end
  double bytes_free = 0;    // on the file's disk
};
SpaceNeeded EstimateSpace(const Frame& frame, const RecordWhat& what, Nanoseconds pose_every,
                          double duration_s, const std::string& file);
/// "about 2.0 MB per simulated second, 58 GB for this run, 40 GB free"
std::string ToString(const SpaceNeeded& space);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// How much room a recorded step takes, and which page size of SQLite suits it. Pure functions.
#pragma once

#include <cstddef>

#include "server/record/recorded_step.h"
#include "server/state/frame.h"

namespace coopdyn {

/// Bytes of a row of table `step` with poses and readings of `frame`, or without; not its commands and
/// messages, which nobody knows before.
std::size_t StepRowBytes(const Frame& frame, const RecordWhat& what, bool shown);
/// Bytes of the file that one row of `row_bytes` takes with pages of `page_size`.
double FileBytesPerRow(std::size_t row_bytes, std::size_t page_size);
/// The least page size, 4096…65536, that wastes little with rows of that many bytes.
std::size_t BestPageSize(std::size_t row_bytes);

}  // namespace coopdyn

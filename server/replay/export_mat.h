// SPDX-License-Identifier: MIT
// A run as a MAT file of level 5: plain `load` in MATLAB and Octave. One thread; knows nothing global, so
// several may run at once with a reader each.
#pragma once

#include <string>

#include "server/record/run_reader.h"
#include "server/replay/export_options.h"

namespace coopdyn {

/// Writes `out`, with one variable, the struct `run`; docs/formats.md says what is in it. An error text,
/// empty if the file is there. Needs as much memory as the numbers take: 8 bytes each, 2 GB at most, as the
/// format allows no more; beyond that an error says what to leave out.
/// @pre LoadScenario() of the reader went well
std::string ExportMat(RunReader& reader, const ExportOptions& options, const std::string& out,
                      const ExportProgress& progress);

}  // namespace coopdyn

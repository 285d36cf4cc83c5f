// SPDX-License-Identifier: MIT
// A run as tables of numbers (docs/formats.md says what is in them): CSV for anything that reads text, a MAT
// file of level 5 for plain `load` in MATLAB and Octave. One thread; knows nothing global, so several may run
// at once with a reader each.
#pragma once

#include <string>
#include <string_view>

#include "server/record/run_reader.h"
#include "server/replay/export_file.h"

namespace coopdyn {

/// Writes `out` (NAME.csv) and NAME-events.csv beside it. An error text, empty if both are there.
/// @pre LoadScenario() of the reader went well
std::string ExportCsv(RunReader& reader, const ExportOptions& options, const std::string& out,
                      const ExportProgress& progress);
/// Where the events of `out` go.
std::string EventsFile(const std::string& out);

/// The shortest digits that read as the same double; `nan`, `inf`, `-inf`. Independent of the locale.
void AppendNumber(double value, std::string& text);
/// `text` in quotes; quotes in it are doubled.
std::string CsvQuoted(std::string_view text);

/// Writes `out`, with one variable, the struct `run`. An error text, empty if the file is there. Needs as
/// much memory as the numbers take: 8 bytes each, 2 GB at most, as the format allows no more; beyond that an
/// error says what to leave out.
/// @pre LoadScenario() of the reader went well
std::string ExportMat(RunReader& reader, const ExportOptions& options, const std::string& out,
                      const ExportProgress& progress);

}  // namespace coopdyn

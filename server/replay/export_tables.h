// SPDX-License-Identifier: MIT
// Exports a run as tables of numbers (contents: docs/formats.md): CSV for anything that reads text, or a
// level 5 MAT file for plain `load` in MATLAB and Octave. One thread; uses no global state, so several
// exports may run at once with a reader each.
#pragma once

#include <string>
#include <string_view>

#include "server/record/run_reader.h"
#include "server/replay/export_file.h"

namespace coopdyn {

/// Writes `out` (NAME.csv) and NAME-events.csv beside it. Returns an error text, empty on success.
/// @pre LoadScenario() of the reader succeeded
std::string ExportCsv(RunReader& reader, const ExportOptions& options, const std::string& out,
                      const ExportProgress& progress);
/// The name of the events file beside `out`.
std::string EventsFile(const std::string& out);

/// The shortest digits that read as the same double; `nan`, `inf`, `-inf`. Independent of the locale.
void AppendNumber(double value, std::string& text);
/// `text` in quotes, with its quotes doubled.
std::string CsvQuoted(std::string_view text);

/// Writes `out` with one variable, the struct `run`. Returns an error text, empty on success. Needs 8 bytes
/// of memory per number, at most 2 GB: the format allows no more. Beyond that the error says what to leave
/// out.
/// @pre LoadScenario() of the reader succeeded
std::string ExportMat(RunReader& reader, const ExportOptions& options, const std::string& out,
                      const ExportProgress& progress);

}  // namespace coopdyn

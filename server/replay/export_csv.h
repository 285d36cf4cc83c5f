// SPDX-License-Identifier: MIT
// A run as one wide table, and its events as another. One thread.
#pragma once

#include <string>
#include <string_view>

#include "server/record/run_reader.h"
#include "server/replay/export_options.h"

namespace coopdyn {

/// Writes `out` (NAME.csv) and NAME-events.csv beside it; docs/formats.md says what is in them. An error
/// text, empty if both are there.
/// @pre LoadScenario() of the reader went well
std::string ExportCsv(RunReader& reader, const ExportOptions& options, const std::string& out,
                      const ExportProgress& progress);
/// Where the events of `out` go.
std::string EventsFile(const std::string& out);

/// The shortest digits that read as the same double; `nan`, `inf`, `-inf`. Independent of the locale.
void AppendNumber(double value, std::string& text);
/// `text` in quotes; quotes in it are doubled.
std::string CsvQuoted(std::string_view text);

}  // namespace coopdyn

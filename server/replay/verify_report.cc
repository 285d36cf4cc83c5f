// SPDX-License-Identifier: MIT
// What verify found, in words.
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "server/replay/verify.h"

namespace coopdyn {

std::string ToString(const VerifyReport& report) {
  std::string text;
  if (!report.error.empty()) {
    text = report.error;
  } else if (report.difference) {
    const Difference& difference = *report.difference;
    const std::size_t width = std::max(difference.recorded_is.size(), difference.repeated_is.size());
    text = fmt::format("differs from step {} on, t = {:g} s: {}{} {}\n", difference.step,
                       ToSeconds(difference.time), difference.what, difference.of_file ? ": its" : "",
                       difference.field);
    text += fmt::format("  {:{}}  {}{}\n", difference.recorded_is, width, difference.recorded,
                        difference.exact ? "" : " (as rounded)");
    text += fmt::format("  {:{}}  {}\n", difference.repeated_is, width, difference.repeated);
    if (difference.value_step != difference.step) {
      text += fmt::format("  at step {}, where it shows first\n", difference.value_step);
    }
    if (!difference.note.empty()) text += "  " + difference.note + "\n";
    text += fmt::format("{} step{} before it {} equal", report.steps, report.steps == 1 ? "" : "s",
                        report.steps == 1 ? "is" : "are");
  } else {
    text = fmt::format("equal, {} step{}", report.steps, report.steps == 1 ? "" : "s");
  }
  if (report.not_verified > 0) {
    // Of a damaged file nobody knows whether they were lost or taken out.
    const bool lost = report.error.empty() && !(report.difference && report.difference->of_file);
    text += fmt::format("; {}{} step{} could not be verified", report.not_verified, lost ? " lost" : "",
                        report.not_verified == 1 ? "" : "s");
  }
  while (text.ends_with('\n')) text.pop_back();
  text += '\n';
  if (!report.warning.empty()) text += "warning: " + report.warning + '\n';
  return text;
}

}  // namespace coopdyn

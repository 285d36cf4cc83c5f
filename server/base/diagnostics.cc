// SPDX-License-Identifier: MIT
#include "server/base/diagnostics.h"

#include <algorithm>
#include <tuple>

#include "server/base/printable.h"

namespace coopdyn {

namespace {

constexpr std::size_t kMostWarnings = 2000;

std::string Counted(std::size_t count, const char* what) {
  return std::to_string(count) + " more " + what + (count == 1 ? "" : "s");
}

}  // namespace

std::string ToString(const SourceLine& where) {
  std::string out = Printable(where.file);
  if (where.line > 0) out += ':' + std::to_string(where.line);
  return out;
}

void Diagnostics::Error(SourceLine where, std::string text) {
  Add({Diagnostic::Level::kError, std::move(where), std::move(text)});
}

void Diagnostics::Warning(SourceLine where, std::string text) {
  Add({Diagnostic::Level::kWarning, std::move(where), std::move(text)});
}

void Diagnostics::Mended(SourceLine where, std::string text) {
  Add({Diagnostic::Level::kMended, std::move(where), std::move(text)});
}

void Diagnostics::Note(SourceLine where, std::string text) {
  Add({Diagnostic::Level::kNote, std::move(where), std::move(text)});
}

void Diagnostics::LeftOut(SourceLine where, std::string what, int count, const std::string& why) {
  std::string text = what + " is not used by coopdyn" + (why.empty() ? "" : ": ") + why;
  if (count > 1) {
    text += " (also " + std::to_string(count - 1) + " more " + (count == 2 ? "time)" : "times)");
  }
  Add({Diagnostic::Level::kWarning, std::move(where), std::move(text), Printable(what), count});
}

void Diagnostics::Add(Diagnostic diagnostic) {
  ++(diagnostic.level == Diagnostic::Level::kError ? errors_ : warnings_);
  Keep(std::move(diagnostic));
}

void Diagnostics::Append(const Diagnostics& other) {
  errors_ += other.errors_;
  warnings_ += other.warnings_;
  for (const Diagnostic& diagnostic : other.all_) Keep(diagnostic);
  if (other.stopped_) stopped_ = other.stopped_;
}

bool Diagnostics::StopAt(const SourceLine& where) {
  if (errors_ <= kHopeless) return false;
  if (!stopped_) stopped_ = where;
  return true;
}

void Diagnostics::Keep(Diagnostic diagnostic) {
  auto place = all_.end();
  if (by_line_of_) {
    const auto before = [this](const Diagnostic& a, const Diagnostic& b) {
      const bool a_is_other = a.where.file != *by_line_of_, b_is_other = b.where.file != *by_line_of_;
      return std::tuple(a_is_other, a_is_other ? 0 : a.where.line) <
             std::tuple(b_is_other, b_is_other ? 0 : b.where.line);
    };
    place = std::upper_bound(all_.begin(), all_.end(), diagnostic, before);
  }
  diagnostic.text = Printable(diagnostic.text);
  const bool counts_as_error = diagnostic.level == Diagnostic::Level::kError;
  all_.insert(place, std::move(diagnostic));
  if (counts_as_error ? ++kept_errors_ <= kMaxKept : all_.size() - kept_errors_ <= kMostWarnings) return;
  // Drop the last error, or the last of the least important warnings.
  const auto by_level = [](const Diagnostic& a, const Diagnostic& b) { return a.level < b.level; };
  const auto last = counts_as_error ? std::min_element(all_.rbegin(), all_.rend(), by_level)
                                    : std::max_element(all_.rbegin(), all_.rend(), by_level);
  all_.erase(std::prev(last.base()));
  if (counts_as_error) --kept_errors_;
}

std::string Diagnostics::ToString() const {
  std::string out;
  std::size_t warnings = 0;
  for (const Diagnostic& diagnostic : all_) {
    const bool is_error = diagnostic.level == Diagnostic::Level::kError;
    if (!is_error && warnings + kept_errors_ >= kMaxKept) continue;
    out += coopdyn::ToString(diagnostic) + '\n';
    if (!is_error) ++warnings;
  }
  const std::size_t more_errors = static_cast<std::size_t>(errors_) - kept_errors_;
  const std::size_t more_warnings = static_cast<std::size_t>(warnings_) - warnings;
  if (more_errors + more_warnings > 0) {
    out += "and " + (more_errors > 0 ? Counted(more_errors, "error") : std::string());
    if (more_warnings > 0) out += (more_errors > 0 ? ", " : "") + Counted(more_warnings, "warning");
    out += '\n';
  }
  if (stopped_) out += coopdyn::ToString(*stopped_) + ": the rest was not read\n";
  return out;
}

std::string ToString(const Diagnostic& diagnostic) {
  return ToString(diagnostic.where) +
         (diagnostic.level == Diagnostic::Level::kError ? ": error: " : ": warning: ") + diagnostic.text;
}

}  // namespace coopdyn

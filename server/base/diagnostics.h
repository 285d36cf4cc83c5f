// SPDX-License-Identifier: MIT
// Errors and warnings of a file reader, reported together, each with file and line.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace coopdyn {

/// A place in a user's file. Line 0: the file as a whole.
struct SourceLine {
  std::string file;
  int line = 0;
  int part = 0;  // distinguishes sections that an experiment makes from the same line
  bool operator==(const SourceLine&) const = default;
};

struct Diagnostic {
  /// All levels but kError print as warnings. kWarning: something is left out. kMended: the reader repaired
  /// something, so it works as intended or nearly so. kNote: affects nothing that moves, senses or is driven.
  enum class Level { kError, kWarning, kMended, kNote };
  Level level = Level::kError;
  SourceLine where;
  std::string text;       // what is wrong and what to write instead; one line, printable
  std::string what = {};  // the part that coopdyn does not use, if `text` reports only that; printable
  int count = 1;          // number of occurrences; `where` is the first
};

/// Collects diagnostics: counts all, keeps 100 errors and 2000 warnings. One thread.
class Diagnostics {
 public:
  static constexpr std::size_t kMaxKept = 100;
  /// Readers stop after more errors than this.
  static constexpr int kHopeless = 1000;

  /// Keeps the first diagnostics found.
  Diagnostics() = default;
  /// Keeps the first diagnostics of `file` by line, then those of other files.
  explicit Diagnostics(std::string file) : by_line_of_(std::move(file)) {}

  void Error(SourceLine where, std::string text);
  void Warning(SourceLine where, std::string text);
  void Mended(SourceLine where, std::string text);
  void Note(SourceLine where, std::string text);
  /// Warns that coopdyn does not use `what`, which occurs `count` times, first at `where`. `why`: why that
  /// matters, if known.
  void LeftOut(SourceLine where, std::string what, int count = 1, const std::string& why = {});
  void Add(Diagnostic diagnostic);
  void Append(const Diagnostics& other);
  /// True after more than kHopeless errors: the reader must stop at `where`, and ToString() says so.
  bool StopAt(const SourceLine& where);
  /// Records that the reader stops at `where`, for a reason that it has reported.
  void Stop(SourceLine where) { stopped_ = std::move(where); }

  bool has_errors() const { return errors_ > 0; }
  int errors() const { return errors_; }
  int warnings() const { return warnings_; }
  /// The kept diagnostics: at most kMaxKept errors and 2000 warnings. Beyond that, notes are dropped first.
  const std::vector<Diagnostic>& all() const { return all_; }
  /// Up to kMaxKept lines `file:line: error: text`, each with '\n'; then the number of omitted ones.
  std::string ToString() const;

 private:
  void Keep(Diagnostic diagnostic);

  std::optional<std::string> by_line_of_;
  std::vector<Diagnostic> all_;
  std::size_t kept_errors_ = 0;  // in all_
  int errors_ = 0, warnings_ = 0;
  std::optional<SourceLine> stopped_;  // where a reader stopped
};

/// `file:line`
std::string ToString(const SourceLine& where);
/// `file:line: error: text` without '\n'.
std::string ToString(const Diagnostic& diagnostic);

}  // namespace coopdyn

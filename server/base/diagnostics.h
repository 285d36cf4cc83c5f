// SPDX-License-Identifier: MIT
// What a reader has to say about a file: all of it at once, each with file and line.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace coopdyn {

/// A place in a text that a user wrote. line 0: the file as a whole.
struct SourceLine {
  std::string file;
  int line = 0;
  int part = 0;  // tells sections apart that an experiment makes of one line
  bool operator==(const SourceLine&) const = default;
};

struct Diagnostic {
  /// All but errors are printed as warnings: something is left out; something was mended, so it runs as it
  /// was meant or nearly so; nothing that moves, senses or is driven is other than it was meant.
  enum class Level { kError, kWarning, kMended, kNote };
  Level level = Level::kError;
  SourceLine where;
  std::string text;       // what is wrong and what to write instead; one line, printable
  std::string what = {};  // what coopdyn does not use, if that is all that `text` says; printable
  int count = 1;          // how many of these there are, `where` the first
};

/// Collects diagnostics: all are counted, 100 errors and 2000 warnings kept. One thread.
class Diagnostics {
 public:
  static constexpr std::size_t kMaxKept = 100;
  /// A file with more errors is not worth reading on.
  static constexpr int kHopeless = 1000;

  /// Keeps the first ones found.
  Diagnostics() = default;
  /// Keeps the first ones of `file` by line; those of other files follow.
  explicit Diagnostics(std::string file) : by_line_of_(std::move(file)) {}

  void Error(SourceLine where, std::string text);
  void Warning(SourceLine where, std::string text);
  void Mended(SourceLine where, std::string text);
  void Note(SourceLine where, std::string text);
  /// A warning: `what` is not used by coopdyn, `count` times, at `where` first. `why` that matters, if the
  /// reader knows.
  void LeftOut(SourceLine where, std::string what, int count = 1, const std::string& why = {});
  void Add(Diagnostic diagnostic);
  void Append(const Diagnostics& other);
  /// True once there are too many errors to read on: the reader stops at `where`, and ToString() says so.
  bool StopAt(const SourceLine& where);
  /// A reader stops at `where` for the reason that it has reported.
  void Stop(SourceLine where) { stopped_ = std::move(where); }

  bool has_errors() const { return errors_ > 0; }
  int errors() const { return errors_; }
  int warnings() const { return warnings_; }
  /// The first ones: at most kMaxKept errors, and 2000 warnings; notes go first.
  const std::vector<Diagnostic>& all() const { return all_; }
  /// `file:line: error: text`, one a line, each ended by '\n'; kMaxKept lines; then how many more.
  std::string ToString() const;

 private:
  void Keep(Diagnostic diagnostic);

  std::optional<std::string> by_line_of_;
  std::vector<Diagnostic> all_;
  std::size_t kept_errors_ = 0;  // of all_
  int errors_ = 0, warnings_ = 0;
  std::optional<SourceLine> stopped_;  // where a reader stopped
};

/// `file:line`
std::string ToString(const SourceLine& where);
/// `file:line: error: text` without '\n'.
std::string ToString(const Diagnostic& diagnostic);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// What a reader has to say about a file: all of it at once, each with file and line.
#pragma once

#include <string>
#include <vector>

namespace coopdyn {

/// A place in a text that a user wrote. line 0: the file as a whole.
struct SourceLine {
  std::string file;
  int line = 0;
};

struct Diagnostic {
  enum class Level { kError, kWarning };
  Level level = Level::kError;
  SourceLine where;
  std::string text;  // what is wrong and what to write instead
};

/// Collects diagnostics in the order found. One thread.
class Diagnostics {
 public:
  void Error(SourceLine where, std::string text);
  void Warning(SourceLine where, std::string text);
  void Append(const Diagnostics& other);

  bool has_errors() const { return errors_ > 0; }
  int errors() const { return errors_; }
  const std::vector<Diagnostic>& all() const { return all_; }
  /// `file:line: error: text`, one a line, each ended by '\n'.
  std::string ToString() const;

 private:
  std::vector<Diagnostic> all_;
  int errors_ = 0;
};

/// `file:line: error: text` without '\n'.
std::string ToString(const Diagnostic& diagnostic);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// The pieces that lines of the text form are made of. Pure; any thread.
#pragma once

#include <string>
#include <string_view>

namespace coopdyn {

/// What a person's terminal meant by the bytes of one line (without its end): telnet negotiation removed,
/// backspace (0x08 and 0x7f) applied to whole UTF-8 characters. Unfinished negotiation stays, and is then no
/// UTF-8.
std::string TidyLine(std::string_view line);

/// Walks over one line, token by token.
class LineScanner {
 public:
  explicit LineScanner(std::string_view line) : rest_(line) {}

  /// Skips blanks; true if nothing is left.
  bool AtEnd();
  /// The next character; '\0' at the end.
  char Peek() const { return rest_.empty() ? '\0' : rest_.front(); }
  /// Everything not yet read.
  std::string_view rest() const { return rest_; }
  /// Skips blanks, then takes everything up to the next blank; empty at the end.
  std::string_view Token();
  /// Takes `count` characters.
  std::string_view Take(std::size_t count);
  /// Takes a quoted text at the front into `text`. Returns what is wrong with it; empty if nothing. @pre
  /// Peek() == '"'
  std::string QuotedText(std::string& text);

 private:
  std::string_view rest_;
};

/// `exit`, `quit` or `bye`, if `word` is that in any case; else empty.
std::string_view Farewell(std::string_view word);

/// Appends `text` in quotes with the escapes of the text form.
void AppendQuotedText(std::string_view text, std::string& out);

}  // namespace coopdyn

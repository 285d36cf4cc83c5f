// SPDX-License-Identifier: MIT
// The pieces that lines of the text form are made of. Pure; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "protocol/command_table.h"
#include "protocol/message.h"

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

/// What a token is when read as a number.
enum class NumberRead {
  kOk,
  kNotNumber,   // not by the grammar
  kOutOfRange,  // a whole number outside int32, or finite digits beyond the largest double
  kHasPoint,    // a number, but not a whole one (ReadInt32 only)
};

/// Reads `[+-]digits`.
NumberRead ReadInt32(std::string_view token, std::int32_t& value);
/// Reads `[+-](digits[.digits*] | .digits)[e int]` or `[+-](inf | nan)`, any case. Digits too small for a
/// double give 0.
NumberRead ReadDouble(std::string_view token, double& value);

/// Says why `token` is not a number and what to write instead, e.g. `'0,5' is not a number: write 0.5`.
std::string NotANumber(std::string_view token);
/// `token` in quotes, cut after 40 bytes at the border of a character.
std::string Quoted(std::string_view token);

/// Reads the rest of a line after `word` by `table`. Returns the request, or an error reply (error != 0): 1
/// and 7 with command -2, what CheckRequest says with the command's own number.
Message ReadNamed(std::string_view word, LineScanner& line, const CommandTable& table);

/// The reply to a line that cannot be read: error 7, command -2.
Message Unreadable(std::string text);

/// Takes one TEXT at the front (quoted, or up to the next blank) into `text`; says what is wrong with it, or
/// nothing.
std::string ReadText(LineScanner& line, std::string& text);

/// Reads a param; says what is wrong with it and what to write instead, or nothing.
std::string ReadParam(std::string_view token, std::int32_t& value);

/// Reads a data value likewise.
std::string ReadData(std::string_view token, double& value);

}  // namespace coopdyn

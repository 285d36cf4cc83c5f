// SPDX-License-Identifier: MIT
// Scanning lines of the text form. Pure; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "protocol/command_table.h"
#include "protocol/message.h"

namespace coopdyn {

/// The text of one line (without its end) as typed at a terminal: removes telnet negotiation and applies
/// backspace (0x08 and 0x7f) to whole UTF-8 characters. Unfinished negotiation stays, which makes the line
/// invalid UTF-8.
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
  /// Skips blanks, then consumes everything up to the next blank; empty at the end.
  std::string_view Token();
  /// Consumes `count` characters.
  std::string_view Take(std::size_t count);
  /// Consumes a quoted text at the front into `text`. Returns the error message; empty if well-formed. @pre
  /// Peek() == '"'
  std::string QuotedText(std::string& text);

 private:
  std::string_view rest_;
};

/// `exit`, `quit` or `bye` if `word` is one of them, case-insensitively; else empty.
std::string_view Farewell(std::string_view word);

/// Appends `text` in quotes with the escapes of the text form.
void AppendQuotedText(std::string_view text, std::string& out);

/// The result of reading a token as a number.
enum class NumberRead {
  kOk,
  kNotNumber,   // does not match the grammar
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
/// `token` in quotes, cut after 40 bytes at a character boundary.
std::string Quoted(std::string_view token);

/// Reads the rest of a line after `word` by `table`. Returns the request, or an error reply (error != 0):
/// errors 1 and 7 with command -2, errors of CheckRequest with the command's number.
Message ReadNamed(std::string_view word, LineScanner& line, const CommandTable& table);

/// The reply to a line that cannot be read: error 7, command -2.
Message Unreadable(std::string text);

/// Consumes one TEXT at the front (quoted, or up to the next blank) into `text`. Returns the error message;
/// empty if well-formed.
std::string ReadText(LineScanner& line, std::string& text);

/// Reads a param. Returns what is wrong and what to write instead; empty if valid.
std::string ReadParam(std::string_view token, std::int32_t& value);

/// The same for a data value.
std::string ReadData(std::string_view token, double& value);

}  // namespace coopdyn

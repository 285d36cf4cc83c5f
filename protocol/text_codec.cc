// SPDX-License-Identifier: MIT
#include <string>
#include <utility>

#include "protocol/ascii.h"
#include "protocol/codec.h"
#include "protocol/command_ids.h"
#include "protocol/text_scan.h"

namespace coopdyn {
namespace {

/// Reads the full form's integer `name`. Returns the error message; empty if valid.
std::string ReadInt(LineScanner& line, std::string_view name, std::int32_t& value) {
  if (line.AtEnd()) return std::string(name) + " is missing";
  std::string why = ReadParam(line.Token(), value);
  return why.empty() ? why : std::string(name) + ": " + why;
}

/// Reads M or N. The list must fit into the rest of the line, so that a count cannot force a large
/// allocation.
std::string ReadCount(LineScanner& line, std::string_view name, std::size_t& count) {
  std::int32_t value = 0;
  std::string why = ReadInt(line, name, value);
  if (!why.empty()) return why;
  if (value < 0) return std::string(name) + " is a count: it cannot be negative";
  count = static_cast<std::size_t>(value);
  if (count > line.rest().size())
    return std::string(name) + " says " + std::to_string(count) + ", but fewer follow";
  return "";
}

std::string ReadFullFields(LineScanner& line, Message& message) {
  std::string why = ReadInt(line, "error", message.error);
  if (!why.empty()) return why;
  if (!line.AtEnd() && (IsDigit(line.Peek()) || line.Peek() == '-' || line.Peek() == '+')) {
    return "the text comes second, \"\" if there is none";
  }
  if (why = ReadText(line, message.text); !why.empty()) return why;
  if (why = ReadInt(line, "command", message.command); !why.empty()) return why;
  std::size_t count = 0;
  if (why = ReadCount(line, "M, the number of params,", count); !why.empty()) return why;
  for (std::size_t i = 0; i < count; ++i) {
    std::int32_t param = 0;
    if (why = ReadInt(line, "param " + std::to_string(i + 1), param); !why.empty()) return why;
    message.params.push_back(param);
  }
  if (why = ReadCount(line, "N, the number of data,", count); !why.empty()) return why;
  for (std::size_t i = 0; i < count; ++i) {
    if (line.AtEnd()) return "data " + std::to_string(i + 1) + " is missing";
    double value = 0;
    if (why = ReadData(line.Token(), value); !why.empty()) return why;
    message.data.push_back(value);
  }
  if (!line.AtEnd()) return "nothing may follow the data";
  return "";
}

void ReadFull(LineScanner& line, Decoded& decoded) {
  const std::string why = ReadFullFields(line, decoded.message);
  decoded.status = why.empty() ? DecodeStatus::kMessage : DecodeStatus::kBad;
  if (why.empty()) return;
  decoded.message =
      Unreadable(why + "; write error \"text\" command M params N data, as in 0 \"\" 11 0 2 0.2 0.5");
}

/// True if `word` closes the connection: /simulation has its own `quit` command.
bool Leaves(std::string_view word, const CommandTable& table) {
  const std::string_view farewell = Farewell(word);
  return !farewell.empty() && table.Find(farewell) == nullptr;
}

Decoded DecodeLine(std::string_view raw, const CommandTable& table, bool first_line) {
  Decoded decoded{DecodeStatus::kNothing, 0, {}};
  const std::string tidy = TidyLine(raw);
  LineScanner line(tidy);
  if (line.AtEnd()) {
    if (first_line) decoded.status = DecodeStatus::kHelp;
    return decoded;
  }
  decoded.status = DecodeStatus::kBad;
  if (!IsCleanUtf8(tidy)) {
    decoded.message = Unreadable("the line is not UTF-8, or holds a NUL; the binary form begins with CDS1");
    return decoded;
  }
  const char first = line.Peek();
  if (first == '#') {
    decoded.status = DecodeStatus::kNothing;
    return decoded;
  }
  if (IsDigit(first) || first == '+' || first == '-') {
    ReadFull(line, decoded);
    return decoded;
  }
  if (!IsLetter(first)) {
    decoded.message = Unreadable(
        "a line starts with a command, as set_velocity 0.2 0.5, or with a number; "
        "help lists the commands");
    return decoded;
  }
  const std::string_view word = line.Token();
  if (word == "OPEN") {
    decoded.message = ErrorReply(
        command::kUnreadable, Error::kNotPossible,
        "this connection is a " + table.module() + " module's already: OPEN another one on a new connection");
    return decoded;
  }
  if (Leaves(word, table) && line.AtEnd()) {
    decoded.status = DecodeStatus::kLeave;
    return decoded;
  }
  if (word == "help" || word == "verbose") {
    if (word == "verbose" && !line.AtEnd()) {
      decoded.message = Unreadable("verbose takes nothing: write verbose");
      return decoded;
    }
    decoded.status = word == "help" ? DecodeStatus::kHelp : DecodeStatus::kVerbose;
    return decoded;
  }
  decoded.message = ReadNamed(word, line, table);
  if (decoded.message.error == 0) decoded.status = DecodeStatus::kMessage;
  return decoded;
}

}  // namespace

Decoded DecodeText(std::string_view bytes, const CommandTable& table, bool first_line) {
  const std::size_t end = bytes.find('\n');
  std::string_view raw = bytes.substr(0, end);
  const bool complete = end != std::string_view::npos;
  const std::string_view content = raw.ends_with('\r') ? raw.substr(0, raw.size() - 1) : raw;
  if (content.size() > kMaxRequestBytes || (!complete && raw.size() > kMaxRequestBytes + 1)) {
    return {DecodeStatus::kFatal, 0,
            ErrorReply(command::kUnreadable, Error::kTooLarge,
                       "a line is too large: at most " + std::to_string(kMaxRequestBytes) +
                           " bytes; the binary form takes larger scenarios")};
  }
  if (!complete) return {};
  Decoded decoded = DecodeLine(content, table, first_line);
  decoded.consumed = end + 1;
  return decoded;
}

void EncodeText(const Message& message, std::string& out) {
  out += std::to_string(message.error) + ' ';
  AppendQuotedText(message.text, out);
  out += ' ' + std::to_string(message.command) + ' ' + std::to_string(message.params.size());
  for (const std::int32_t param : message.params) out += ' ' + std::to_string(param);
  out += ' ' + std::to_string(message.data.size());
  for (const double value : message.data) {
    out += ' ';
    AppendDouble(value, out);
  }
  out += '\n';
}

}  // namespace coopdyn

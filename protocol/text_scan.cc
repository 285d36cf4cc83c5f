// SPDX-License-Identifier: MIT
#include "protocol/text_scan.h"

#include <algorithm>
#include <array>

#include "protocol/ascii.h"

namespace coopdyn {
namespace {

constexpr char kBackspace = '\x08';
constexpr char kDelete = '\x7F';
constexpr unsigned char kIac = 0xFF;   // interpret as command (RFC 854)
constexpr unsigned char kSe = 0xF0;    // end of a sub-negotiation
constexpr unsigned char kSb = 0xFA;    // start of a sub-negotiation
constexpr unsigned char kWill = 0xFB;  // WILL, WONT, DO, DONT: one option byte follows

/// Length of the telnet command at the front of `bytes`; 0 if invalid or incomplete. @pre `bytes` starts with
/// IAC
std::size_t TelnetCommandBytes(std::string_view bytes) {
  if (bytes.size() < 2) return 0;
  const auto code = static_cast<unsigned char>(bytes[1]);
  if (code == kIac || code < kSe) return 0;
  if (code >= kWill) return bytes.size() < 3 ? 0 : 3;
  if (code != kSb) return 2;
  const std::size_t end = bytes.find("\xFF\xF0", 2);
  return end == std::string_view::npos ? 0 : end + 2;
}

void RemoveLastCharacter(std::string& line) {
  while (!line.empty()) {
    const auto last = static_cast<unsigned char>(line.back());
    line.pop_back();
    if ((last & 0xC0) != 0x80) return;
  }
}

}  // namespace

std::string TidyLine(std::string_view line) {
  std::string tidy;
  tidy.reserve(line.size());
  // If one sub-negotiation has no end, no later one has either; searching again each time would be quadratic.
  bool unfinished = false;
  for (std::size_t i = 0; i < line.size();) {
    const char c = line[i];
    if (static_cast<unsigned char>(c) == kIac && !unfinished) {
      const std::size_t skip = TelnetCommandBytes(line.substr(i));
      i += skip;
      if (skip > 0) continue;
      unfinished = true;
    }
    if (c == kBackspace || c == kDelete) {
      RemoveLastCharacter(tidy);
    } else {
      tidy += c;
    }
    ++i;
  }
  return tidy;
}

bool LineScanner::AtEnd() {
  rest_.remove_prefix(
      static_cast<std::size_t>(std::find_if_not(rest_.begin(), rest_.end(), IsBlank) - rest_.begin()));
  return rest_.empty();
}

std::string_view LineScanner::Token() {
  AtEnd();
  return Take(static_cast<std::size_t>(std::find_if(rest_.begin(), rest_.end(), IsBlank) - rest_.begin()));
}

std::string_view LineScanner::Take(std::size_t count) {
  const std::string_view taken = rest_.substr(0, count);
  rest_.remove_prefix(taken.size());
  return taken;
}

std::string LineScanner::QuotedText(std::string& text) {
  Take(1);
  while (!rest_.empty()) {
    const char c = Take(1).front();
    if (c == '"') {
      if (rest_.empty() || IsBlank(rest_.front())) return "";
      return "put a space after the closing quote; a quote inside a text is written \\\"";
    }
    if (c != '\\') {
      text += c;
      continue;
    }
    const char meant = EscapedBy(Peek());
    if (meant == '\0') return "the only escapes are \\\" \\\\ \\n \\r \\t: write \\\\ for a backslash";
    text += meant;
    Take(1);
  }
  return "the closing quote is missing";
}

std::string_view Farewell(std::string_view word) {
  constexpr std::array<std::string_view, 3> kFarewells{"exit", "quit", "bye"};
  const auto found = std::find_if(kFarewells.begin(), kFarewells.end(), [word](std::string_view farewell) {
    return std::equal(word.begin(), word.end(), farewell.begin(), farewell.end(),
                      [](char a, char b) { return ToLower(a) == b; });
  });
  return found == kFarewells.end() ? std::string_view() : *found;
}

void AppendQuotedText(std::string_view text, std::string& out) {
  out += '"';
  for (const char c : text) {
    if (const char letter = EscapeLetter(c); letter != '\0') {
      out += '\\';
      out += letter;
    } else {
      out += (static_cast<unsigned char>(c) < 0x20 || c == kDelete) ? '?' : c;
    }
  }
  out += '"';
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/naming/name_talk.h"

#include <utility>

namespace coopdyn {
namespace {

/// Removes the lines "*** end...", which end an answer to a plain line.
std::string WithoutEnd(const std::string& answer) {
  std::string text;
  for (std::size_t begin = 0; begin < answer.size();) {
    const std::size_t end = std::min(answer.find('\n', begin), answer.size() - 1) + 1;
    const std::string line = answer.substr(begin, end - begin);
    if (!line.starts_with("*** end")) text += line;
    begin = end;
  }
  return text.empty() ? "\r\n" : text;
}

}  // namespace

std::optional<NameTalk> NameTalk::Begin(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  for (const std::string_view word : {"CONNECT ", "CONNACK "}) {
    if (line.starts_with(word) && line.find("HTTP/") == std::string_view::npos)
      return NameTalk(std::string(line.substr(word.size())), word == "CONNACK ");
  }
  return {};
}

NameReply NameTalk::Acknowledged(std::string text) const {
  return {std::move(text) + (acknowledges_ ? "<ACK>\r\n" : "")};
}

NameReply NameTalk::Answer(std::string_view line, const NameContext& context, NameTable& table) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  const Expects expected = std::exchange(expects_, Expects::kCommand);
  if (expected == Expects::kCommand) return AnswerCommand(line);
  if (expected == Expects::kAdministration) {
    return Acknowledged(line == "[ver]" || line == "ver"
                            ? "[ver] 1 2 3\r\n"
                            : "[fail] \"send [help] for list of valid commands\"\r\n");
  }
  const std::string request = "NAME_SERVER " + std::string(line);  // the prefix excludes OPEN, which is
                                                                   // impossible here
  const std::string answer = AnswerNameLine(request, context, table).text;
  return Acknowledged(expected == Expects::kRequest ? WithoutEnd(answer) : "");
}

NameReply NameTalk::AnswerCommand(std::string_view command) {
  const std::string_view word = command.substr(0, command.find(' '));
  if (word == "d" || word == "D" || word == "do" || word == "a") {
    expects_ = word == "d"   ? Expects::kRequest
               : word == "a" ? Expects::kAdministration
                             : Expects::kRequestWithoutReply;
    return {};
  }
  if (word == "q") {
    NameReply goodbye = Acknowledged("");
    goodbye.close = true;
    return goodbye;
  }
  if (word == "*") return Acknowledged("This is the name server\r\n");
  return Acknowledged(
      "Port command not understood.\r\nType d to send data to the port's owner.\r\nType ? for help.\r\n");
}

}  // namespace coopdyn

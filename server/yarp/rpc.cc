// SPDX-License-Identifier: MIT
#include "server/yarp/rpc.h"

#include <algorithm>
#include <string>
#include <utility>

#include "protocol/ascii.h"
#include "protocol/command_ids.h"
#include "protocol/text_scan.h"

namespace coopdyn {
namespace {

constexpr std::size_t kFields = 5;  // error, text, command, params, data

Decoded Bad(std::string why) {
  return {DecodeStatus::kBad, 0, ErrorReply(command::kUnreadable, Error::kMalformed, std::move(why))};
}

Decoded DecodeMessage(const Bottle& bottle) {
  Decoded decoded{DecodeStatus::kMessage, 0, {}};
  Message& message = decoded.message;
  message.error = *bottle[0].As<std::int32_t>();
  message.text = bottle[1].word();
  message.command = *bottle[2].As<std::int32_t>();
  if (!IsCleanUtf8(message.text)) return Bad("the text is not UTF-8");
  for (const BottleValue& item : *bottle[3].As<Bottle>()) {
    const auto* const param = item.As<std::int32_t>();
    if (param == nullptr)
      return Bad("the params, the fourth value, are whole numbers: not " + BottleText(BottleOf(item)));
    message.params.push_back(*param);
  }
  for (const BottleValue& item : *bottle[4].As<Bottle>()) {
    const std::optional<double> number = NumberOf(item);
    if (!number) return Bad("the data, the fifth value, are numbers: not " + BottleText(BottleOf(item)));
    message.data.push_back(*number);
  }
  return decoded;
}

/// Appends one value as in a line of text.
void AppendWord(const BottleValue& item, std::string& line) {
  if (const Bottle* const list = item.As<Bottle>()) {
    line += '(';
    for (const BottleValue& inner : *list) {
      if (&inner != list->data()) line += ' ';
      AppendWord(inner, line);
    }
    line += ')';
    return;
  }
  const std::string_view word = item.word();
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](char c) {
    return IsLetter(c) || IsDigit(c) || (c > ' ' && c != '"' && c != '\\' && c != '\x7f');
  });
  if (plain) {
    line += word;
  } else if (item.As<std::string>() != nullptr || item.As<YarpVocab>() != nullptr) {
    AppendQuotedText(word, line);
  } else {
    line += BottleText(BottleOf(item));
  }
}

}  // namespace

bool IsMessageBottle(const Bottle& bottle) {
  return bottle.size() == kFields && bottle[0].As<std::int32_t>() && bottle[1].As<std::string>() &&
         bottle[2].As<std::int32_t>() && bottle[3].As<Bottle>() && bottle[4].As<Bottle>();
}

Decoded DecodeYarpRequest(const Bottle& bottle, const CommandTable& table) {
  if (IsMessageBottle(bottle)) return DecodeMessage(bottle);
  if (bottle.empty() || bottle.front().word().empty())
    return Bad(
        "a request begins with a command: help lists them; or it is error text command (params) (data)");
  std::string line;
  for (const BottleValue& item : bottle) {
    if (&item != bottle.data()) line += ' ';
    AppendWord(item, line);
  }
  Decoded decoded = DecodeText(line + "\n", table, false);
  if (decoded.status == DecodeStatus::kNeedMore || decoded.status == DecodeStatus::kNothing)
    return Bad("this is no request: help lists the commands");
  return decoded;
}

Bottle MessageBottle(const Message& message) {
  Bottle params, data;
  for (const std::int32_t param : message.params) params.emplace_back(param);
  for (const double value : message.data) data.emplace_back(value);
  return BottleOf(message.error, message.text, message.command, std::move(params), std::move(data));
}

Bottle WordsBottle(const Message& reply) {
  if (reply.error != 0) return BottleOf(YarpVocab{"fail"}, reply.text, reply.error);
  Bottle bottle = BottleOf(YarpVocab{"ok"});
  if (!reply.text.empty()) bottle.emplace_back(reply.text);
  for (const std::int32_t param : reply.params) bottle.emplace_back(param);
  for (const double value : reply.data) bottle.emplace_back(value);
  return bottle;
}

Bottle HelpBottle(const CommandTable& table) {
  Bottle bottle = BottleOf(YarpVocab{"many"});
  const std::string help = HelpText(table);
  for (std::string_view rest = help; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    if (line.starts_with('#')) line.remove_prefix(line.starts_with("# ") ? 2 : 1);
    if (!line.empty()) bottle.emplace_back(std::string(line));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return bottle;
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "protocol/message.h"

#include <array>
#include <utility>

namespace coopdyn {

Message ReplyTo(std::int32_t command, std::string text) {
  Message reply;
  reply.text = std::move(text);
  reply.command = command;
  return reply;
}

Message ErrorReply(std::int32_t command, Error error, std::string text) {
  return Message{.error = static_cast<std::int32_t>(error),
                 .text = std::move(text),
                 .command = command,
                 .params = {},
                 .data = {}};
}

std::string_view ErrorMeaning(std::int32_t error) {
  static constexpr std::array<std::string_view, 13> kMeanings = {"ok",
                                                                 "unknown command",
                                                                 "wrong params",
                                                                 "wrong data",
                                                                 "out of range or not finite",
                                                                 "not possible in this mode or state",
                                                                 "owned by another client",
                                                                 "malformed message",
                                                                 "too large",
                                                                 "internal error",
                                                                 "no such name",
                                                                 "timed out",
                                                                 "not allowed"};
  if (error < 0 || error >= static_cast<std::int32_t>(kMeanings.size())) return "unknown error";
  return kMeanings[static_cast<std::size_t>(error)];
}

}  // namespace coopdyn

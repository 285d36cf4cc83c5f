// SPDX-License-Identifier: MIT
#include "server/yarp/board_translator.h"

#include <utility>

#include "protocol/command_ids.h"

namespace coopdyn {

Decoded BoardTranslator::Decode(const Bottle& request) {
  switch (language_) {
    case Language::kWords:
      words_ = ReadBoardWords(request);
      call_ = words_.call;
      break;
    case Language::kRpc:
      rpc_ = ReadBoardRpc(request);
      call_ = rpc_.call;
      break;
    case Language::kStream:
      call_ = ReadBoardStream(request);
      break;
  }
  asked_ = true;
  sent_ = 0;
  answer_ = {};
  Decoded decoded{DecodeStatus::kMessage, 0, {}};
  decoded.message.command = command::kGetBoard;
  return decoded;
}

std::optional<Message> BoardTranslator::Next(const Message& reply) {
  if (std::exchange(asked_, false)) {
    if (std::optional<BoardState> state = ReadBoard(reply)) {
      time_s_ = state->time_s;
      answer_ = client_.Answer(call_, *std::move(state));
    } else {
      answer_ = {.kind = BoardAnswer::Kind::kFailed, .why = reply.text};
    }
  } else if (sent_ > 0) {
    if (reply.error == 0) {
      client_.Taken(answer_.commands[sent_ - 1], reply);
    } else {
      answer_ = {.kind = BoardAnswer::Kind::kFailed, .why = reply.text};
    }
  }
  if (sent_ < answer_.commands.size()) return answer_.commands[sent_++];
  sent_ = 0;
  return {};
}

YarpAnswer BoardTranslator::Reply(const Message& reply) {
  if (reply.command == command::kUnreadable) return {BoardFailure(reply.text), {}};
  if (language_ == Language::kRpc) {
    if (rpc_.fixed) return *rpc_.fixed;
    YarpDialect dialect = YarpDialect::k4;
    std::string bytes = BoardRpcReply(rpc_, answer_, time_s_);
    Bottle shown = DecodeBottle(bytes, dialect).value_or(Bottle());
    if (!answer_.why.empty()) shown.emplace_back(answer_.why);
    return {std::move(shown), std::move(bytes)};
  }
  if (language_ == Language::kStream) {
    if (answer_.kind == BoardAnswer::Kind::kDone) return {BottleOf(YarpVocab{"ok"}), {}};
    return {BoardFailure(answer_.why), {}};
  }
  const bool stamped =
      words_.form == BoardRequest::Form::kGet || words_.form == BoardRequest::Form::kGetAll ||
      words_.form == BoardRequest::Form::kBare || words_.form == BoardRequest::Form::kBareAll;
  return {BoardWords(words_, answer_, time_s_, stamped ? count_++ : count_), {}};
}

}  // namespace coopdyn

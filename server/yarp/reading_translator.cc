// SPDX-License-Identifier: MIT
#include "server/yarp/reading_translator.h"

namespace coopdyn {
namespace {

/// The name of a call, which Thrift splits at each `_`: joins the words up to the one that ends with RPC; if
/// none does, the first word. `at` receives the index of the first argument.
std::string CallName(const Bottle& request, std::size_t& at) {
  std::string name;
  for (std::size_t i = 0; i < request.size() && i < 4; ++i) {
    const std::string_view word = request[i].word();
    if (word.empty()) break;
    name += (i == 0 ? "" : "_") + std::string(word);
    at = i + 1;
    if (word.ends_with("RPC")) return name;
  }
  at = 1;
  return std::string(WordAt(request, 0));
}

}  // namespace

Decoded ReadingTranslator::Decode(const Bottle& request) {
  request_ = request;
  at_ = 1;
  name_ = CallName(request_, at_);
  if (name_ == "getRemoteProtocolVersion") dialect_ = YarpDialect::k4;
  asked_ = true;
  Decoded decoded{DecodeStatus::kMessage, 0, {}};
  decoded.message.command = Reading();
  return decoded;
}

YarpAnswer ReadingTranslator::Reply(const Message& reply) {
  if (name_ == "getRemoteProtocolVersion" && reply.error == 0) return YarpProtocolVersion();
  if (name_ == "help") return {BottleOf(YarpVocab{"many"}, std::string(Help())), {}};
  if (reply.error != 0) return Fail(reply.text);
  if (std::optional<YarpAnswer> answer = Answer(reply)) return *std::move(answer);
  return Fail("there is no such request here: " + std::string(Help()));
}

}  // namespace coopdyn

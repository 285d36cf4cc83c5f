// SPDX-License-Identifier: MIT
#include "server/yarp/translator.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "protocol/command_ids.h"
#include "server/yarp/board_translator.h"
#include "server/yarp/device_rpc.h"
#include "server/yarp/port_name.h"
#include "server/yarp/struct_writer.h"
#include "server/yarp/world_interface.h"

namespace coopdyn {
namespace {

/// The clock of gazebo-yarp-plugins 4 (plugins/clock/thrift/ClockServer.thrift).
class ClockTranslator final : public YarpTranslator {
 public:
  Decoded Decode(const Bottle& request) override {
    call_ = Find(request.empty() ? std::string_view() : request.front().word());
    if (WordAt(request, 0) == "help") return Bad("the calls are " + Names());
    if (call_ == nullptr) return Bad("there is no such call: " + Names());
    Decoded decoded{DecodeStatus::kMessage, 0, {}};
    decoded.message.command = call_->command;
    if (call_->command != command::kStep) return decoded;
    const std::optional<std::int32_t> steps = request.size() < 2 ? 1
                                              : request[1].As<std::int32_t>()
                                                  ? std::optional(*request[1].As<std::int32_t>())
                                                  : std::nullopt;
    if (!steps || *steps < 1) {
      call_ = nullptr;
      return Bad("the number of steps is a whole one from 1 on, as in stepSimulation 10");
    }
    decoded.message.params = {*steps};
    return decoded;
  }

  YarpAnswer Reply(const Message& reply) override { return {AnswerOf(reply), {}}; }

 private:
  Bottle AnswerOf(const Message& reply) const {
    if (call_ == nullptr && reply.text.starts_with("the calls are"))
      return BottleOf(YarpVocab{"many"}, reply.text);
    if (call_ == nullptr || reply.error != 0) return BottleOf(YarpVocab{"fail"}, reply.text, reply.error);
    const std::size_t size = reply.data.size();
    switch (call_->reply) {
      case Answer::kTime:
        return size < 2 ? Bottle() : BottleOf(reply.data[size - 2]);
      case Answer::kStepLength:
        return size < 3 ? Bottle() : BottleOf(reply.data[size - 3]);
      case Answer::kNone:
        return BottleOf(YarpVocab{"done"});
      case Answer::kEmpty:
        break;
    }
    return {};
  }

  enum class Answer { kNone, kEmpty, kTime, kStepLength };
  struct Call {
    std::string_view name;
    command::Id command;
    Answer reply;
  };
  static constexpr std::array<Call, 9> kCalls = {{
      {"pauseSimulation", command::kPause, Answer::kNone},
      {"continueSimulation", command::kRun, Answer::kNone},
      {"stepSimulation", command::kStep, Answer::kNone},
      {"stepSimulationAndWait", command::kStep, Answer::kEmpty},
      {"resetSimulationTime", command::kReset, Answer::kEmpty},
      {"resetSimulation", command::kReset, Answer::kEmpty},
      {"resetSimulationState", command::kReset, Answer::kEmpty},
      {"getSimulationTime", command::kGetClock, Answer::kTime},
      {"getStepSize", command::kGetClock, Answer::kStepLength},
  }};

  static const Call* Find(std::string_view name) {
    const auto* const found =
        std::find_if(kCalls.begin(), kCalls.end(), [name](const Call& call) { return call.name == name; });
    return found == kCalls.end() ? nullptr : found;
  }
  static std::string Names() {
    std::string names;
    for (const Call& call : kCalls) names += (names.empty() ? "" : ", ") + std::string(call.name);
    return names;
  }
  static Decoded Bad(std::string why) {
    return {DecodeStatus::kBad, 0, ErrorReply(command::kUnreadable, Error::kUnknownCommand, std::move(why))};
  }

  const Call* call_ = nullptr;
};

}  // namespace

YarpAnswer YarpProtocolVersion() {
  // Four 16-bit numbers, which Bottles do not support.
  YarpAnswer version{BottleOf(std::int32_t{0}, std::int32_t{4}, std::int32_t{0}, std::int32_t{0}), {}};
  YarpStructWriter(YarpDialect::k4, version.bytes).Struct(1);
  for (const std::int16_t number : {0, 4, 0, 0}) AppendBytes(number, version.bytes);
  return version;
}

std::unique_ptr<YarpTranslator> TranslatorOf(std::string_view port, const CommandTable& table,
                                             std::shared_ptr<YarpMadeThings> made) {
  using Language = BoardTranslator::Language;
  const YarpTalk talk = TalkOf(port, table).value_or(YarpTalk::kModule);
  switch (talk) {
    case YarpTalk::kModule:
      return nullptr;
    case YarpTalk::kClock:
      return std::make_unique<ClockTranslator>();
    case YarpTalk::kWorld:
      return MakeWorldTranslator(made != nullptr ? std::move(made) : std::make_shared<YarpMadeThings>());
    case YarpTalk::kBoardWords:
      return std::make_unique<BoardTranslator>(Language::kWords);
    case YarpTalk::kBoardRpc:
      return std::make_unique<BoardTranslator>(Language::kRpc);
    case YarpTalk::kBoardStream:
      return std::make_unique<BoardTranslator>(Language::kStream);
    default:
      return MakeDeviceTranslator(talk, port, table);
  }
}

}  // namespace coopdyn

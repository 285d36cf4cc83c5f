// SPDX-License-Identifier: MIT
// The UDP protocol of YARS as its paper has it, of 2008, from the robot's side: datagrams in, datagrams,
// requests to the module `channel` and orders for the world out. Pure: no sockets, no clock. One thread.
//
// A datagram is little-endian int32 and float32: an id, its fields, −1. A client may add a number after the
// −1: the answer then carries it, too, and a repeated number gets the same answer again without another step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/message.h"
#include "server/yars/udp_handshake.h"
#include "server/yars/wire.h"
#include "server/yars/world.h"

namespace coopdyn {

class YarsUdpTalk {
 public:
  static constexpr std::size_t kMaxDatagram = 1024, kUsable = YarsUdpHandshake::kUsable;
  static constexpr std::size_t kValuesEach = 250;     // in one datagram
  static constexpr std::size_t kUnacknowledged = 80;  // datagrams
  static constexpr std::size_t kRemembered = 16;      // numbers: what comes later is late
  static constexpr std::size_t kMaxText = std::size_t{4} << 20;

  /// What is to be done now.
  struct Action {
    std::vector<std::string> datagrams = {};  // to be sent
    std::optional<Message> request = {};      // for the module; Answer() takes its reply
    std::optional<YarsOrder> order = {};      // for the world; Done() takes its reply
    bool leaves = false;                      // the client does not come back
    std::string trouble = {};                 // what was wrong with the datagram
  };

  /// A datagram that is nonsense is answered with what is wrong: kRefused, the length of a text, the text,
  /// −1.
  static constexpr std::int32_t kRefused = 99;

  /// While it waits for the module or the world, a copy of what it works on is ignored; of other datagrams
  /// the last is taken up afterwards.
  Action Take(std::string_view datagram);
  /// @pre a request is under way
  Action Answer(const Message& reply);
  /// @pre an order is under way
  Action Done(const Message& reply);
  /// Instead of an action with an order that may not be, because of `why`: what is said besides stays.
  Action Denied(Action action, const std::string& why);
  /// The module has gone, and another one takes its place: what the last one has not answered is asked of
  /// this one, but a step is over.
  Action MoveOn();
  bool waits() const { return waiting_ != Waiting::kNot; }

  /// The answer to who is not the robot's client.
  static std::string Refusal(const std::string& why);

 private:
  enum class Waiting { kNot, kChannel, kStep, kValues, kWorld };

  Action Begin(std::string_view datagram);
  Action Handle(std::int32_t id, YarsReader& fields);
  Action Handshake(YarsReader& fields);
  Action Step(std::int32_t id, YarsReader& fields);
  Action NewSimulation(YarsReader& fields);
  Action NewSimulationData(YarsReader& fields, std::int32_t index);
  Action Order(YarsOrder order, std::int32_t ack, std::optional<std::int32_t> failed);
  Action Refuse(const std::string& why);
  /// Refusal(), not finished.
  static std::string Refused(const std::string& why);
  Action Send(std::vector<std::string> datagrams);
  /// The answer to a request that has been answered already: the same, if it was the last.
  std::optional<Action> AnswerAgain();
  /// `numbers`, then −1 and the number of the request.
  std::string Finish(std::string datagram) const;
  static std::string Ints(std::initializer_list<std::int32_t> numbers);
  /// What waited for the end of `action`, after it.
  Action GoOn(Action action);
  static Action Joined(Action first, Action then);

  YarsUdpHandshake handshake_;
  bool knows_channel_ = false;
  bool knows_auxiliary_ = true;  // else the client shook hands without them
  Waiting waiting_ = Waiting::kNot;
  std::string current_, later_;           // datagrams: being worked on, and to be taken up then
  std::vector<std::string> last_answer_;  // to current_
  std::optional<std::int32_t> number_;    // of the request
  std::optional<std::int32_t> last_number_;
  std::deque<std::int32_t> numbers_;  // of the last requests
  bool moved_ = false;                // the values wait for what the new module tells of itself

  std::vector<double> motors_;  // of a step whose datagrams come
  std::size_t motor_datagrams_ = 0;
  std::int32_t step_id_ = 0, ack_ = 0;
  std::optional<std::int32_t> failed_;
  std::vector<std::string> left_;  // of the values: sent when the client asks for more

  struct Upload {
    std::int32_t id = 0, source = 0;
    std::size_t each = 0, missing = 0;
    std::string text;
    std::vector<bool> has;
  };
  std::optional<Upload> upload_;
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// The robot's side of YARS's UDP protocol of 2008, as in its paper: receives datagrams; returns datagrams,
// requests to the module `channel`, and orders for the world. Pure: no sockets, no clock. One thread.
//
// A datagram consists of little-endian int32 and float32 numbers: an id, its fields, −1. A client may add a
// number after the −1. The answer then ends with the number, too, and a repeated number gets the same answer
// again without another step.
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
  static constexpr std::size_t kValuesEach = 250;     // per datagram
  static constexpr std::size_t kUnacknowledged = 80;  // datagrams
  static constexpr std::size_t kRemembered = 16;      // request numbers: a repetition of one of them is late
  static constexpr std::size_t kMaxText = std::size_t{4} << 20;

  /// The next actions of the caller.
  struct Action {
    std::vector<std::string> datagrams = {};  // to send
    std::optional<Message> request = {};      // for the module; pass its reply to Answer()
    std::optional<YarsOrder> order = {};      // for the world; pass its reply to Done()
    bool leaves = false;                      // the client has left
    std::string trouble = {};                 // the error in the datagram
  };

  /// Start of the answer to an invalid datagram: kRefused, the length of a text with the reason, the text,
  /// −1.
  static constexpr std::int32_t kRefused = 99;

  /// Handles a datagram. While waiting for the module or the world, ignores repetitions of the current
  /// datagram, and keeps the last other one for later.
  Action Take(std::string_view datagram);
  /// @pre a request is pending
  Action Answer(const Message& reply);
  /// @pre an order is pending
  Action Done(const Message& reply);
  /// Replaces an order that is refused, because of `why`; keeps the rest of the action.
  Action Denied(Action action, const std::string& why);
  /// The module has been replaced. A pending step is answered with the new module's values; other pending
  /// requests are sent again.
  Action MoveOn();
  bool waits() const { return waiting_ != Waiting::kNot; }

  /// The answer to anybody but the robot's client.
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
  /// Refusal() without its end.
  static std::string Refused(const std::string& why);
  Action Send(std::vector<std::string> datagrams);
  /// The answer to a repeated request: the same as before if it was the last one.
  std::optional<Action> AnswerAgain();
  /// `datagram`, then −1 and the request's number.
  std::string Finish(std::string datagram) const;
  static std::string Ints(std::initializer_list<std::int32_t> numbers);
  /// Starts the datagram kept for later, after `action`.
  Action Resume(Action action);
  static Action Joined(Action first, Action then);

  YarsUdpHandshake handshake_;
  bool knows_channel_ = false;
  bool knows_auxiliary_ = true;  // false: the client's handshake had none
  Waiting waiting_ = Waiting::kNot;
  std::string current_, later_;           // datagrams: the current one, and the one kept for later
  std::vector<std::string> last_answer_;  // to last_number_
  std::optional<std::int32_t> number_;    // of the request
  std::optional<std::int32_t> last_number_;
  std::deque<std::int32_t> numbers_;  // of the last requests
  bool moved_ = false;                // the values wait for the new module's description

  std::vector<double> motors_;  // of a step whose datagrams are arriving
  std::size_t motor_datagrams_ = 0;
  std::int32_t step_id_ = 0, ack_ = 0;
  std::optional<std::int32_t> failed_;
  std::vector<std::string> left_;  // remaining values: sent when the client asks for more

  struct Upload {
    std::int32_t id = 0, source = 0;
    std::size_t each = 0, missing = 0;
    std::string text;
    std::vector<bool> has;
  };
  std::optional<Upload> upload_;
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/yars/udp_talk.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "protocol/command_ids.h"

namespace coopdyn {

namespace {

enum : std::int32_t {
  kEnd = -1,
  kPing = 0,
  kPingAck = 1,
  kHandshake = 10,
  kHandshakeAck = 11,
  kExtended = 12,
  kExtendedAck = 13,
  kSensors = 20,
  kMotors = 30,
  kStep = 40,
  kReset = 50,
  kInit = 60,
  kNextTry = 70,
  kParallel = 80,
  kSerial = 82,
  kNewSimulation = 90,
  kNewSimulationAck = 91,
  kNewSimulationFailed = 92,
  kClear = 93,
  kClearAck = 94,
  kQuit = 100,
  kQuitAck = 101,
};
constexpr std::int32_t kRobot = 0;
constexpr const char* kOtherRobot =
    "the robot of this port is number 0: each robot has a port of its own, where it is the only one";

/// The acknowledgement of request `id`; uploads have their own.
std::int32_t AckOf(std::int32_t id) {
  return id + 1;
}

}  // namespace

std::string YarsUdpTalk::Ints(std::initializer_list<std::int32_t> numbers) {
  std::string out;
  for (const std::int32_t number : numbers) PutInt(number, out);
  return out;
}

std::string YarsUdpTalk::Finish(std::string datagram) const {
  PutInt(kEnd, datagram);
  if (number_) PutInt(*number_, datagram);
  return datagram;
}

std::string YarsUdpTalk::Refused(const std::string& why) {
  const std::string text = why.substr(0, kUsable - 16);
  return Ints({kRefused, static_cast<std::int32_t>(text.size())}) + text;
}

std::string YarsUdpTalk::Refusal(const std::string& why) {
  std::string out = Refused(why);
  PutInt(kEnd, out);
  return out;
}

YarsUdpTalk::Action YarsUdpTalk::Refuse(const std::string& why) {
  Action action = Send({Finish(Refused(why))});
  action.trouble = why;
  return action;
}

YarsUdpTalk::Action YarsUdpTalk::Send(std::vector<std::string> datagrams) {
  last_answer_ = datagrams;
  last_number_ = number_;
  if (number_) numbers_.push_back(*number_);
  if (numbers_.size() > kRemembered) numbers_.pop_front();
  return {.datagrams = std::move(datagrams)};
}

std::optional<YarsUdpTalk::Action> YarsUdpTalk::AnswerAgain() {
  if (!number_) return std::nullopt;
  if (number_ == last_number_ && !last_answer_.empty()) return Action{.datagrams = last_answer_};
  if (std::find(numbers_.begin(), numbers_.end(), *number_) == numbers_.end()) return std::nullopt;
  const std::string why = "request " + std::to_string(*number_) + " has been answered: numbers go up";
  return Action{.datagrams = {Finish(Refused(why))}, .trouble = why};
}

YarsUdpTalk::Action YarsUdpTalk::Take(std::string_view datagram) {
  if (datagram.size() == 1) return {};  // a client announces itself
  if (!waits()) return Begin(datagram);
  if (datagram != current_) later_ = datagram;
  return {};
}

YarsUdpTalk::Action YarsUdpTalk::Resume(Action action) {
  if (waits() || later_.empty()) return action;
  const std::string next = std::exchange(later_, {});
  return Joined(std::move(action), Begin(next));
}

YarsUdpTalk::Action YarsUdpTalk::Joined(Action first, Action then) {
  then.datagrams.insert(then.datagrams.begin(), first.datagrams.begin(), first.datagrams.end());
  then.leaves = then.leaves || first.leaves;
  if (then.trouble.empty()) then.trouble = std::move(first.trouble);
  return then;
}

YarsUdpTalk::Action YarsUdpTalk::Begin(std::string_view datagram) {
  current_ = datagram;
  number_.reset();
  if (datagram.size() > kMaxDatagram) return Refuse("a datagram has at most 1024 bytes");
  YarsReader whole(datagram);
  const std::optional<std::int32_t> id = whole.Int();
  if (!id) return Refuse("a datagram begins with an int32, the id of the request");
  const bool is_reset = id == kReset || id == kInit || id == kNextTry;  // also possible without a robot
  if (!knows_channel_ && !is_reset) {
    waiting_ = Waiting::kChannel;
    return {.request = ReplyTo(command::kGetChannel)};
  }
  return Handle(*id, whole);
}

YarsUdpTalk::Action YarsUdpTalk::Handle(std::int32_t id, YarsReader& fields) {
  // Finds the end of a request with `ints` fields; steps and uploads find theirs themselves.
  const auto end = [&](std::size_t ints) {
    YarsReader rest = fields;
    for (std::size_t i = 0; i < ints; ++i) rest.Int();
    if (rest.Int() != kEnd) return false;
    number_ = rest.Int();
    return true;
  };
  const auto other_robot = [&] { return fields.Int() != kRobot; };
  const std::string unfinished =
      "the request " + std::to_string(id) + " does not end with -1 where it should";
  switch (id) {
    case kPing:
      if (!end(0)) return Refuse(unfinished);
      return Send({Finish(Ints({kPingAck}))});
    case kHandshake: {
      if (!end(0)) return Refuse(unfinished);
      if (std::optional<Action> answer = AnswerAgain()) return *std::move(answer);
      knows_auxiliary_ = false;
      std::string datagram = Ints({kHandshakeAck});
      handshake_.AppendBasic(datagram);
      return Send({Finish(std::move(datagram))});
    }
    case kExtended:
      if (!end(0) && !end(1)) return Refuse(unfinished);
      if (std::optional<Action> answer = AnswerAgain()) return *std::move(answer);
      knows_auxiliary_ = true;
      return Handshake(fields);
    case kSensors: {
      if (!end(1)) return Refuse(unfinished);
      if (other_robot()) return Refuse(kOtherRobot);
      step_id_ = id;
      waiting_ = Waiting::kValues;
      return {.request = ReplyTo(command::kGetValues)};
    }
    case kMotors:
    case kStep:
      return Step(id, fields);
    case kInit:
    case kNextTry:
    case kReset: {
      if (!end(id == kReset ? 1 : 2)) return Refuse(unfinished);
      if (std::optional<Action> answer = AnswerAgain()) return *std::move(answer);
      if (other_robot()) return Refuse(kOtherRobot);
      YarsOrder order;
      if (id != kReset) order.seed = static_cast<std::uint32_t>(fields.Int().value_or(0));
      return Order(std::move(order), AckOf(id), std::nullopt);
    }
    case kClear:
      // The next experiment replaces this one at once.
      if (!end(0)) return Refuse(unfinished);
      upload_.reset();
      return Send({Finish(Ints({kClearAck}))});
    case kNewSimulation:
      return NewSimulation(fields);
    case kQuit: {
      if (!end(0)) return Refuse(unfinished);
      Action action = Send({Finish(Ints({kQuitAck}))});
      action.leaves = true;
      action.order = YarsOrder{.kind = YarsOrder::Kind::kQuit};
      return action;
    }
    default:
      return Refuse("there is no request " + std::to_string(id) +
                    ": 0 ping, 10 and 12 handshake, 20 sensors, 40 step, 50 reset, 60 init, 70 next try, "
                    "93 clear, 90 new simulation, 100 quit");
  }
}

YarsUdpTalk::Action YarsUdpTalk::Handshake(YarsReader& fields) {
  const std::int32_t mode = fields.Int().value_or(kEnd);
  if (mode != kEnd && mode != kSerial && mode != kParallel)
    return Refuse("the extended handshake is 12, 82 (serial) or 80 (parallel), -1");
  std::string datagram = Ints({kExtendedAck});
  if (mode != kEnd) PutInt(AckOf(mode), datagram);
  if (mode != kEnd || !handshake_.in_extended()) handshake_.BeginExtended();
  handshake_.AppendExtended(datagram);
  return Send({Finish(std::move(datagram))});
}

// --- steps

YarsUdpTalk::Action YarsUdpTalk::Step(std::int32_t id, YarsReader& fields) {
  const std::int32_t robot = fields.Int().value_or(kEnd);
  if (robot == kEnd && fields.left() < 8) {  // a request for more values
    number_ = fields.Int();
    if (left_.empty()) return Refuse("nothing is left to be sent: a step is 40, robot, count, motors, -1");
    const std::size_t count = std::min(left_.size(), kUnacknowledged);
    std::vector<std::string> some(left_.begin(), left_.begin() + static_cast<std::ptrdiff_t>(count));
    left_.erase(left_.begin(), left_.begin() + static_cast<std::ptrdiff_t>(count));
    return Send(std::move(some));
  }
  const std::int32_t count = fields.Int().value_or(kEnd);
  const std::size_t expected = handshake_.motor_order().size();
  const bool begins = count == static_cast<std::int32_t>(expected);
  if (begins) {
    motors_.clear();
    motor_datagrams_ = 0;
  }
  if (count < 0 || motors_.size() + static_cast<std::size_t>(count) != expected) {
    motors_.clear();
    return Refuse("the robot has " + std::to_string(expected) + " motors, not " + std::to_string(count) +
                  ": a step is 40, robot, count, motors, -1");
  }
  // A datagram ends with −1 and perhaps a number; everything before is values.
  const std::size_t words = fields.left() / 4;
  const std::size_t here = std::min(static_cast<std::size_t>(count), words == 0 ? 0 : words - 1);
  for (std::size_t i = 0; i < here; ++i) motors_.push_back(fields.Float().value_or(NAN));
  if (fields.Int() != kEnd ||
      std::any_of(motors_.begin(), motors_.end(), [](double value) { return !std::isfinite(value); })) {
    motors_.clear();
    return Refuse("a step is 40, robot, count, motors, -1, and all motors are finite numbers");
  }
  number_ = fields.Int();
  if (std::optional<Action> answer = AnswerAgain()) {
    motors_.clear();
    return *std::move(answer);
  }
  if (robot != kRobot) {
    motors_.clear();
    return Refuse(kOtherRobot);
  }
  if (motors_.size() < expected) {
    const bool wants_ack = ++motor_datagrams_ % kUnacknowledged == 0;
    return wants_ack ? Send({Finish(Ints({AckOf(id)}))}) : Action{};
  }
  step_id_ = id;
  waiting_ = Waiting::kStep;
  Action action;
  action.request.emplace();
  action.request->command = command::kSetMotors;
  action.request->data.resize(expected);
  for (std::size_t i = 0; i < expected; ++i) action.request->data[handshake_.motor_order()[i]] = motors_[i];
  motors_.clear();
  return action;
}

YarsUdpTalk::Action YarsUdpTalk::MoveOn() {
  if (waiting_ == Waiting::kWorld || !waits()) {
    knows_channel_ = false;
    return {};
  }
  moved_ = moved_ || waiting_ != Waiting::kChannel;
  waiting_ = Waiting::kChannel;
  return {.request = ReplyTo(command::kGetChannel)};
}

YarsUdpTalk::Action YarsUdpTalk::Answer(const Message& reply) {
  // Another module replaces this one soon, or the port learns that it has none: MoveOn().
  if (reply.error != 0 && reply.text.ends_with(kGoneText)) return {};
  const Waiting waited = std::exchange(waiting_, Waiting::kNot);
  if (waited == Waiting::kChannel) {
    const bool moved = std::exchange(moved_, false);
    if (reply.error != 0) return Resume(Refuse(reply.text));
    YarsUdpHandshake handshake(YarsChannel::Of(reply));
    const bool is_same = handshake.IsLike(handshake_);
    handshake_ = std::move(handshake);
    knows_channel_ = true;
    if (!moved) return Resume(Begin(std::string(current_)));
    if (!is_same)
      return Resume(Refuse("the robot has been edited and has other motors or values: shake hands"));
    waiting_ = Waiting::kValues;
    return {.request = ReplyTo(command::kGetValues)};
  }
  if (reply.error == static_cast<std::int32_t>(Error::kNotPossible) && waited == Waiting::kStep) {
    // Another robot's client has ended the step by a reset: answers with the current values.
    waiting_ = Waiting::kValues;
    return {.request = ReplyTo(command::kGetValues)};
  }
  if (reply.error != 0) return Resume(Refuse(reply.text));
  constexpr std::int32_t kAbort = 1;
  const std::int32_t state = reply.text == "aborted" ? kAbort : 0;
  const std::vector<std::size_t>& order = handshake_.value_order();
  const std::size_t count = knows_auxiliary_ ? order.size() : handshake_.sensor_count();
  std::vector<std::string> datagrams;
  std::size_t sent = 0;
  do {
    std::string datagram = Ints({AckOf(step_id_), kRobot, state, static_cast<std::int32_t>(count - sent)});
    for (std::size_t i = 0; i < kValuesEach && sent < count; ++i, ++sent) {
      const std::size_t index = order[sent];
      PutFloat(index < reply.data.size() ? static_cast<float>(reply.data[index]) : 0, datagram);
    }
    datagrams.push_back(Finish(std::move(datagram)));
  } while (sent < count);
  left_.clear();
  if (datagrams.size() > kUnacknowledged) {
    left_.assign(datagrams.begin() + kUnacknowledged, datagrams.end());
    datagrams.resize(kUnacknowledged);
  }
  return Resume(Send(std::move(datagrams)));
}

// --- the world

YarsUdpTalk::Action YarsUdpTalk::Denied(Action action, const std::string& why) {
  if (action.order->kind != YarsOrder::Kind::kQuit)
    return Joined(std::move(action), Done(ErrorReply(0, Error::kOwned, why)));
  action.datagrams.pop_back();  // the acknowledgement
  action.leaves = false;
  return Joined(std::move(action), Refuse(why));
}

YarsUdpTalk::Action YarsUdpTalk::Order(YarsOrder order, std::int32_t ack,
                                       std::optional<std::int32_t> failed) {
  ack_ = ack;
  failed_ = failed;
  waiting_ = Waiting::kWorld;
  Action action;
  action.order = std::move(order);
  return action;
}

YarsUdpTalk::Action YarsUdpTalk::Done(const Message& reply) {
  waiting_ = Waiting::kNot;
  knows_channel_ = false;  // the robot may have changed
  left_.clear();
  if (reply.error != 0 && !failed_) return Resume(Refuse(reply.text));
  const bool has_failed = reply.error != 0;
  std::string datagram = Ints({has_failed ? *failed_ : ack_});
  if (!failed_) PutInt(kRobot, datagram);
  Action action = Send({Finish(std::move(datagram))});
  if (has_failed) action.trouble = reply.text;
  return Resume(std::move(action));
}

YarsUdpTalk::Action YarsUdpTalk::NewSimulation(YarsReader& fields) {
  const std::int32_t id = fields.Int().value_or(0), size = fields.Int().value_or(0);
  // A datagram of the text begins like this one: an id, then the datagram's index.
  if (upload_ && upload_->id == id && size >= 0 && static_cast<std::size_t>(size) < upload_->has.size())
    return NewSimulationData(fields, size);
  const std::int32_t each = fields.Int().value_or(0), source = fields.Int().value_or(0);
  constexpr std::int32_t kMostEach = 1004;
  if (size <= 0 || static_cast<std::size_t>(size) > kMaxText || each <= 0 || each > kMostEach || source < 0 ||
      source > 1) {
    return Refuse(
        "a new simulation is 90, an id, 1 to 4194304 bytes, 1 to 1004 bytes a datagram, 0 (the name of "
        "a file) or 1 (XML), mask, try, individual, -1");
  }
  Upload upload;
  upload.id = id;
  upload.source = source;
  upload.each = static_cast<std::size_t>(each);
  upload.text.resize(static_cast<std::size_t>(size));
  upload.missing = (upload.text.size() + upload.each - 1) / upload.each;
  upload.has.resize(upload.missing);
  upload_ = std::move(upload);
  return Send({Finish(Ints({kNewSimulationAck}))});
}

YarsUdpTalk::Action YarsUdpTalk::NewSimulationData(YarsReader& fields, std::int32_t index) {
  Upload& upload = *upload_;
  if (index < 0 || static_cast<std::size_t>(index) >= upload.has.size())
    return Refuse("the new simulation has " + std::to_string(upload.has.size()) +
                  " datagrams: " + std::to_string(index) + " is none of them");
  const auto place = static_cast<std::size_t>(index);
  const std::size_t from = place * upload.each, count = std::min(upload.each, upload.text.size() - from);
  const std::optional<std::string_view> bytes = fields.Bytes(count);
  if (!bytes || fields.Int() != kEnd)
    return Refuse("datagram " + std::to_string(index) + " of the new simulation has " +
                  std::to_string(count) + " bytes and -1");
  if (!upload.has[place]) {
    upload.has[place] = true;
    --upload.missing;
    std::copy(bytes->begin(), bytes->end(), upload.text.begin() + static_cast<std::ptrdiff_t>(from));
  }
  if (upload.missing > 0) {
    const bool wants_ack = place > 0 && place % kUnacknowledged == 0;
    return wants_ack ? Send({Finish(Ints({kNewSimulationAck}))}) : Action{};
  }
  using Kind = YarsOrder::Kind;
  YarsOrder order{.kind = upload.source == 0 ? Kind::kLoadFile : Kind::kLoadText,
                  .text = std::move(upload.text)};
  upload_.reset();
  return Order(std::move(order), kNewSimulationAck, kNewSimulationFailed);
}

}  // namespace coopdyn

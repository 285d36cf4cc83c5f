// SPDX-License-Identifier: MIT
#include "server/yarp/stream.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "protocol/codec.h"
#include "protocol/command_ids.h"
#include "server/yarp/sensor_samples.h"

namespace coopdyn {
namespace {

constexpr std::size_t kStamped = 2;  // time_s and step, at the end of a reading

/// The number of dropped pushes in a push's text.
std::int32_t DroppedBefore(std::string_view text) {
  constexpr std::string_view kDropped = "dropped ";
  std::int32_t count = 0;
  if (text.starts_with(kDropped))
    std::from_chars(text.data() + kDropped.size(), text.data() + text.size(), count);
  return count;
}

}  // namespace

void YarpSampleWriter::Append(const Message& reading, YarpCarrier carrier, YarpDialect dialect,
                              std::string& out) {
  if (reading.data.size() < kStamped) return;
  const auto end = reading.data.end() - kStamped;
  const std::int32_t dropped = DroppedBefore(reading.text);
  const bool board = sample_ == YarpSample::kBoard || sample_ == YarpSample::kBoardPositions;
  const bool plain = sample_ == YarpSample::kReading || sample_ == YarpSample::kParams;
  const std::optional<BoardState> state = board ? ReadBoard(reading) : std::nullopt;
  if (board && !state) return;
  Bottle sample;
  std::string payload;
  if (sample_ == YarpSample::kBoardPositions) {
    sample = BoardPositions(*state);
  } else if (sample_ == YarpSample::kBoard) {
    board_.AppendState(*state, dialect, payload);
  } else if (!plain) {
    if (!AppendSensorSample(sample_, reading, geometry_, dialect, payload)) return;
  } else {
    if (dropped == 0 && !reading.text.empty()) sample.emplace_back(reading.text);
    for (const std::int32_t param : reading.params) sample.emplace_back(param);
    if (sample_ == YarpSample::kReading)
      std::for_each(reading.data.begin(), end, [&sample](double value) { sample.emplace_back(value); });
  }
  if (IsText(carrier)) {
    if (!payload.empty()) sample = DecodeBottle(payload, dialect).value_or(Bottle());
    payload = BottleText(sample);
  } else if (payload.empty()) {
    EncodeBottle(sample, dialect, payload);
  }
  sequence_ += dropped;
  std::string head = "D " + std::to_string(sequence_++) + " ";
  AppendDouble(*end, head);
  AppendYarpMessage(carrier, head, payload, out);
}

YarpOutput::YarpOutput(YarpCarrier carrier, YarpDialect dialect, YarpStream stream, Events events)
    : carrier_(carrier), dialect_(dialect), stream_(stream), events_(std::move(events)) {
  writer_.set_sample(stream.sample);
}

YarpOutput::~YarpOutput() {
  if (events_.end) events_.end();
}

Incoming YarpOutput::Decode(std::string_view bytes) {
  Incoming incoming{.status = DecodeStatus::kMessage};
  switch (state_) {
    case State::kWelcome:  // send a sample at once: a reader may wait for the first one
      state_ = State::kFirstReading;
      incoming.message = FirstRequest();
      return incoming;
    case State::kFirstReading:
      state_ = State::kStreams;
      incoming.consumed = WelcomeBytes(carrier_, bytes).value_or(bytes.size());
      if (pulls() && unacknowledged_ > 0) {
        incoming.status = DecodeStatus::kNothing;
      } else if (pulls()) {
        incoming.message = NextStep();
      } else {
        incoming.message.command = command::kSubscribe;
        incoming.message.params = {stream_.every, stream_.reading};
      }
      return incoming;
    case State::kStreams:
      break;
  }
  return Acknowledged(bytes);
}

Message YarpOutput::FirstRequest() const {
  if (pulls()) return Picture();
  Message request;
  request.command =
      stream_.sample == YarpSample::kLaserScan ? command::kGetScanGeometry : command::Id{stream_.reading};
  return request;
}

Message YarpOutput::Picture() const {
  constexpr std::int32_t kRgb = 0, kDepth = 2;
  Message request;
  request.command = command::kGetImage;
  request.params = {stream_.sample == YarpSample::kDepth ? kDepth : kRgb};
  return request;
}

Message YarpOutput::NextStep() const {
  Message request;
  request.command = command::kReady;
  request.params = {stream_.every};
  return request;
}

std::optional<Message> YarpOutput::Next(const Message& reply, std::string& out) {
  if (reply.command == command::kGetScanGeometry) {
    writer_.set_geometry(reply);
    Message request;
    request.command = stream_.reading;
    return request;
  }
  if (!pulls()) return {};
  constexpr int kMaxErrors = 4;  // a reset or a load; after more, the stream is dead
  errors_ = reply.error == 0 ? 0 : errors_ + 1;
  if (errors_ > kMaxErrors) {
    if (events_.fails) events_.fails(reply.text);
    return {};
  }
  if (reply.command == command::kReady) return Picture();
  return reply.command == command::kGetImage ? AfterPicture(reply, out) : std::nullopt;
}

std::optional<Message> YarpOutput::AfterPicture(const Message& picture, std::string& out) {
  const bool is_new = picture.error == 0 && picture.data.size() >= kStamped && picture.data[0] != pulled_s_;
  if (is_new) {
    pulled_s_ = picture.data[0];
    Append(picture, out);
  }
  if (state_ != State::kStreams || unacknowledged_ > 0) return {};
  return NextStep();
}

Incoming YarpOutput::Acknowledged(std::string_view bytes) {
  Incoming incoming{.status = DecodeStatus::kNothing};
  const std::string_view ack = YarpAck(carrier_);
  if (ack.empty()) {
    incoming.consumed = bytes.size();  // nothing else is expected from the reader
    return incoming;
  }
  // An acknowledgement of tcp has a fixed size; one of text ends with its line.
  const std::size_t end = IsText(carrier_)            ? bytes.find('\n') + 1
                          : bytes.size() < ack.size() ? 0
                                                      : ack.size();
  incoming.consumed = end;
  if (end > 0 && unacknowledged_ > 0) --unacknowledged_;
  if (end > 0 && unacknowledged_ == 0 && events_.taken) events_.taken(sent_step_);
  if (end > 0 && unacknowledged_ == 0 && pulls()) {
    incoming.status = DecodeStatus::kMessage;
    incoming.message = NextStep();
  }
  return incoming;
}

void YarpOutput::Append(const Message& reading, std::string& out) {
  const std::size_t before = out.size();
  writer_.Append(reading, carrier_, dialect_, out);
  if (out.size() == before) return;
  sent_step_ = static_cast<std::uint64_t>(reading.data.back());
  if (!YarpAck(carrier_).empty()) ++unacknowledged_;
}

void YarpOutput::Reply(const Message& reply, std::string& out) {
  if (reply.command == stream_.reading && reply.error == 0 && !pulls()) Append(reply, out);
}

void YarpOutput::Push(UnaskedMessage& push, std::string& out) {
  const Message& message = *push.message();
  if (message.command == command::kClosing) return AppendYarpMessage(carrier_, "q", {}, out);
  Append(message, out);
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "server/yars/tcp_encoding.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

#include "protocol/command_ids.h"
#include "server/yars/wire.h"

namespace coopdyn {

namespace {

constexpr std::size_t kHead = 5;  // the letter and a count
constexpr std::uint32_t kMostText = std::uint32_t{1} << 16, kMostNumbers = 20'000;

std::uint32_t CountAt(std::string_view bytes) {
  return static_cast<std::uint32_t>(YarsReader(bytes.substr(1)).Int().value_or(0));
}

/// A value from a client.
struct TcpValue {
  enum class State { kNeedMore, kWhole, kBroken };
  State state = State::kNeedMore;
  std::size_t size = 0;  // including its letter
  char letter = 0;
  std::string_view text;
  std::vector<double> numbers;
};

TcpValue ReadTcpValue(std::string_view bytes) {
  TcpValue value;
  if (bytes.empty()) return value;
  value.letter = bytes[0];
  std::size_t each = 0, count = 1, head = 1;
  switch (value.letter) {
    case 'd':
      each = 8;
      break;
    case 'i':
      each = 4;
      break;
    case 's':
    case 'D':
    case 'I':
      each = value.letter == 's' ? 1 : value.letter == 'D' ? 8 : 4;
      head = kHead;
      if (bytes.size() < kHead) return value;
      count = CountAt(bytes);
      break;
    default:
      value.state = TcpValue::State::kBroken;
      return value;
  }
  if (count > (each == 1 ? kMostText : kMostNumbers)) {
    value.state = TcpValue::State::kBroken;
    return value;
  }
  value.size = head + each * count;
  if (bytes.size() < value.size) return value;
  value.state = TcpValue::State::kWhole;
  YarsReader rest(bytes.substr(head));
  if (each == 1) {
    value.text = bytes.substr(head, count);
    return value;
  }
  for (std::size_t i = 0; i < count; ++i)
    value.numbers.push_back(each == 8 ? rest.Double().value_or(0) : rest.Int().value_or(0));
  return value;
}

void AppendText(std::string_view text, std::string& out) {
  out += 's';
  PutInt(static_cast<std::int32_t>(text.size()), out);
  out += text;
}

/// One connection.
class YarsTcpEncoding final : public Encoding {
 public:
  YarsTcpEncoding(const Endpoint& endpoint, YarsWorld& world) : endpoint_(&endpoint), world_(world) {}

  void Attach(const Connection& connection, const Endpoint& endpoint) override {
    connection_ = &connection;
    endpoint_ = &endpoint;
  }
  bool outlives_module() const override { return true; }
  std::optional<Message> AskedAgain(const Message& /*reply*/) override {
    if (asks_ == Asks::kSensors) return ReplyTo(command::kGetValues);
    if (asks_ == Asks::kConfiguration) return ReplyTo(command::kGetChannel);
    return std::nullopt;
  }

  Incoming Decode(std::string_view bytes) override {
    if (endpoint_->table().Find(command::kSetMotors) == nullptr)
      return Fatal(endpoint_->path() +
                   " has no motors and values for clients of YARS: connect to the robot's module channel");
    const TcpValue value = ReadTcpValue(bytes);
    if (value.state == TcpValue::State::kNeedMore) return {};
    if (value.state == TcpValue::State::kBroken)
      return Fatal(
          "this is no value of YARS's TCP protocol: d, i, s, D or I, then little-endian bytes, at most "
          "65536 of a text and 20000 numbers");
    Incoming incoming = awaited_ ? Awaited(value) : Command(value);
    incoming.consumed = value.size;
    return incoming;
  }

  void Reply(const Message& reply, std::string& out) override {
    switch (std::exchange(asks_, Asks::kNothing)) {
      case Asks::kConfiguration:
        if (reply.error == 0) AppendConfiguration(YarsChannel::Of(reply), out);
        break;
      case Asks::kSensors: {
        const std::size_t count = reply.data.size() < 2 ? 0 : reply.data.size() - 2;
        out += 'D';
        PutInt(static_cast<std::int32_t>(count), out);
        for (std::size_t i = 0; i < count; ++i) PutDouble(reply.data[i], out);
        break;
      }
      default:
        break;  // no answer
    }
  }

  std::string Warning(const Message& reply) override {
    const bool is_reset = reply.error == static_cast<std::int32_t>(Error::kNotPossible);
    if (asks_ != Asks::kStep || reply.error == 0 || is_reset || std::exchange(logged_, true)) return {};
    return endpoint_->path() + " has not taken ACTUATORS, and nothing has moved: " + reply.text +
           " (later ones are not told)";
  }

  void Push(UnaskedMessage& /*push*/, std::string& /*out*/) override {}

 private:
  enum class Asks { kNothing, kConfiguration, kSensors, kStep, kWorld };

  /// Sends the reason as a text and closes the connection.
  static Incoming Fatal(const std::string& why) {
    Incoming incoming{DecodeStatus::kFatal, 0, ErrorReply(command::kUnreadable, Error::kMalformed, why)};
    AppendText("ERROR " + why, incoming.answer);
    return incoming;
  }
  static Incoming Ask(Asks& asks, Asks what, Message request) {
    asks = what;
    return {.status = DecodeStatus::kMessage, .message = std::move(request)};
  }
  Incoming AskWorld(YarsOrder order) {
    const bool leaves = order.kind == YarsOrder::Kind::kQuit;
    const bool changes = leaves ? world_.quits() : order.kind != YarsOrder::Kind::kLog;
    if (const std::string driver =
            changes && connection_ != nullptr ? endpoint_->DriverBeside(*connection_) : "";
        !driver.empty())
      return Fatal(YarsDrivenText(robot(), driver));
    asks_ = Asks::kWorld;
    return {.status = leaves ? DecodeStatus::kLeave : DecodeStatus::kNothing,
            .ask = [this, order = std::move(order)](const Connection& asker, ReplyFunction reply) {
              world_.Ask(order, asker, std::move(reply));
            }};
  }

  Incoming Command(const TcpValue& value) {
    if (value.letter != 's') return Fatal("a command is a text: CONFIGURATION, SENSORS, ACTUATORS, …");
    const std::string_view word = value.text;
    if (word == "SENSORS") return Ask(asks_, Asks::kSensors, ReplyTo(command::kGetValues));
    if (word == "CONFIGURATION") return Ask(asks_, Asks::kConfiguration, ReplyTo(command::kGetChannel));
    if (word == "ACTUATORS" || word == "RANDOM SEED" || word == "MESSAGE") {
      awaited_ = word == "ACTUATORS" ? 'D' : word == "MESSAGE" ? 's' : 'i';
      return {.status = DecodeStatus::kNothing};
    }
    if (word == "RESET") return AskWorld({.seed = std::exchange(seed_, std::nullopt)});
    if (word == "QUIT") return AskWorld({.kind = YarsOrder::Kind::kQuit});
    return Fatal("there is no command '" + std::string(word.substr(0, 40)) +
                 "': CONFIGURATION, SENSORS, ACTUATORS, RESET, RANDOM SEED, MESSAGE or QUIT");
  }

  /// Handles the value that follows a command.
  Incoming Awaited(const TcpValue& value) {
    const char letter = std::exchange(awaited_, 0);
    if (value.letter != letter)
      return Fatal(fmt::format("the command before is followed by {}, not {}", letter, value.letter));
    if (letter == 's') return AskWorld({.kind = YarsOrder::Kind::kLog, .text = std::string(value.text)});
    if (letter == 'i') {
      seed_ = static_cast<std::uint32_t>(static_cast<std::int64_t>(value.numbers.front()));
      return {.status = DecodeStatus::kNothing};
    }
    Message request = ReplyTo(command::kSetMotors);
    request.data = value.numbers;
    return Ask(asks_, Asks::kStep, std::move(request));
  }

  void AppendConfiguration(const YarsChannel& channel, std::string& out) const {
    const auto line = [&out](const std::string& text) { AppendText(text, out); };
    line("BEGIN CONFIGURATION");
    line("BEGIN DATA TYPES");
    line("INTEGER 4 bytes, little endian");
    line("DOUBLE 8 bytes, little endian");
    line("END DATA TYPES");
    line("BEGIN ROBOT DATA");
    line("NAME " + robot());
    const auto entries = [&](const std::vector<YarsEntry>& all, const std::string& word) {
      for (std::size_t i = 0; i < all.size();) {
        std::size_t end = i + 1;  // entries of the same name form one, of this dimension
        while (end < all.size() && all[end].name == all[i].name) ++end;
        line("BEGIN " + word);
        line("NAME " + all[i].name);
        line(fmt::format("DIMENSION {}", end - i));
        for (; i < end; ++i) {
          line(fmt::format("INTERNAL DOMAIN {:.6g} {:.6g}", all[i].internal_min, all[i].internal_max));
          line(fmt::format("EXTERNAL DOMAIN {:.6g} {:.6g}", all[i].external_min, all[i].external_max));
        }
        line("END " + word);
      }
    };
    entries(channel.values, "SENSOR");
    entries(channel.motors, "ACTUATOR");
    line("END ROBOT DATA");
    line("END CONFIGURATION");
  }

  std::string robot() const {
    const std::string& path = endpoint_->path();
    return path.substr(1, path.rfind('/') - 1);
  }

  const Endpoint* endpoint_;
  YarsWorld& world_;
  const Connection* connection_ = nullptr;
  char awaited_ = 0;  // letter of the value that must follow the last command; 0: none
  Asks asks_ = Asks::kNothing;
  bool logged_ = false;                // a refusal of ACTUATORS has been logged
  std::optional<std::uint64_t> seed_;  // for the next reset
};

}  // namespace

EncodingKind YarsTcpEncodingKind(YarsWorld& world) {
  // Matches a text or list of size up to 65535: no line of text starts with such bytes.
  const auto match = [](std::string_view first) {
    if (first.empty()) return Match::kMaybe;
    if (std::string_view("sDI").find(first[0]) == std::string_view::npos) return Match::kNo;
    const bool is_line = first.size() < kHead && first.find('\n') != std::string_view::npos;
    for (std::size_t i = 3; i < std::min(first.size(), kHead); ++i) {
      if (first[i] != 0) return Match::kNo;
    }
    return is_line ? Match::kNo : first.size() < kHead ? Match::kMaybe : Match::kYes;
  };
  return {match, [&world](const Endpoint& endpoint) -> std::unique_ptr<Encoding> {
            return std::make_unique<YarsTcpEncoding>(endpoint, world);
          }};
}

}  // namespace coopdyn

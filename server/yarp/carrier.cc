// SPDX-License-Identifier: MIT
#include "server/yarp/carrier.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "protocol/codec.h"
#include "server/yarp/bottle.h"
#include "server/yarp/yarp_bytes.h"

namespace coopdyn {
namespace {

constexpr std::int32_t kFirstCode = 7777;  // plus the carrier's code
constexpr std::size_t kHeaderBytes = 8;    // 'Y' 'A' int32 'R' 'P'
constexpr std::int32_t kIndexBytes = 10;
constexpr std::array<std::string_view, 6> kNames = {"tcp", "fast_tcp", "udp", "text", "text_ack", "unknown"};
constexpr std::string_view kConnect = "CONNECT ", kConnectAck = "CONNACK ";

YarpInput NeedMore() {
  return {};
}

YarpInput Broken(std::string why) {
  return {YarpInput::Kind::kBroken, 0, std::move(why)};
}

std::optional<std::int32_t> HeaderNumber(std::string_view bytes) {
  if (!bytes.starts_with("YA") || bytes.substr(6, 2) != "RP") return {};
  return ByteScanner(bytes.substr(2)).Take<std::int32_t>();
}

std::string Header(std::int32_t number) {
  std::string bytes = "YA";
  AppendBytes(number, bytes);
  return bytes + "RP";
}

/// "/src (recv portmonitor)" becomes /src.
std::string WithoutQualifiers(std::string_view name) {
  return std::string(name.substr(0, std::min(name.find_first_of(std::string_view(" \0", 2)), name.size())));
}

YarpCarrier CarrierOf(std::int32_t header) {
  const std::int32_t code = header - kFirstCode;
  switch (code % 16) {
    case 0:
      return YarpCarrier::kUdp;
    case 3:
      return (code & 128) != 0 ? YarpCarrier::kTcp : YarpCarrier::kFastTcp;
    default:
      return YarpCarrier::kOther;
  }
}

bool TakesBottle(std::string_view command) {
  return command == "d" || command == "D" || command == "do" || command == "a";
}

/// Splits "D 3598 1795.8" into D and its envelope.
void SplitEnvelope(YarpInput& input) {
  const std::string& text = input.text;
  if (text.size() < 2 || text[1] != ' ' || (text[0] != 'd' && text[0] != 'D')) return;
  input.envelope = text.substr(2);
  input.text.resize(1);
}

}  // namespace

std::string_view CarrierName(YarpCarrier carrier) {
  return kNames[static_cast<std::size_t>(carrier)];
}

YarpCarrier CarrierNamed(std::string_view name) {
  const auto* const found = std::find(kNames.begin(), kNames.end() - 1, name);
  return static_cast<YarpCarrier>(found - kNames.begin());
}

Match BeginsYarp(std::string_view first_bytes) {
  for (const std::string_view word : {kConnect, kConnectAck}) {
    if (!word.starts_with(first_bytes.substr(0, word.size()))) continue;
    const std::size_t end = first_bytes.find('\n');
    if (end == std::string_view::npos)
      return first_bytes.size() < YarpReader::kMaxNameBytes ? Match::kMaybe : Match::kNo;
    return first_bytes.substr(0, end).find("HTTP/") == std::string_view::npos ? Match::kYes : Match::kNo;
  }
  for (std::size_t i = 0; i < std::min(first_bytes.size(), kHeaderBytes); ++i) {
    const char c = first_bytes[i];
    const bool fits = i == 2   ? c != '\n'  // a line of text
                      : i == 3 ? c == '\x1e' || c == '\x1f'
                               : c == std::string_view("YA\0\0\0\0RP", 8)[i];
    if (!fits) return Match::kNo;
  }
  return first_bytes.size() < kHeaderBytes ? Match::kMaybe : Match::kYes;
}

YarpInput YarpReader::Next(std::string_view bytes) {
  if (!greeted_) return Hello(bytes);
  return is_text() ? Line(bytes) : Frame(bytes);
}

YarpInput YarpReader::Hello(std::string_view bytes) {
  YarpInput hello{YarpInput::Kind::kHello};
  std::string_view name;
  if (bytes.starts_with(kConnect) || bytes.starts_with(kConnectAck)) {
    const std::size_t end = bytes.find('\n');
    if (end == std::string_view::npos)
      return bytes.size() > kMaxNameBytes ? Broken("the line CONNECT is too long") : NeedMore();
    carrier_ = bytes.starts_with(kConnect) ? YarpCarrier::kText : YarpCarrier::kTextAck;
    name = bytes.substr(kConnect.size(), end - kConnect.size());
    if (name.ends_with('\r')) name.remove_suffix(1);
    hello.consumed = end + 1;
  } else {
    ByteScanner scanner(bytes);
    const std::optional<std::string_view> header = scanner.TakeBytes(kHeaderBytes);
    if (!header) return NeedMore();
    carrier_ = CarrierOf(HeaderNumber(*header).value_or(0));
    if (carrier_ == YarpCarrier::kOther)
      return Broken(
          "mcast, shmem and other carriers of YARP are not served: connect by tcp, fast_tcp, udp, text or "
          "text_ack");
    const std::optional<std::int32_t> size = scanner.Take<std::int32_t>();
    if (!size) return NeedMore();
    if (*size < 0 || static_cast<std::size_t>(*size) > kMaxNameBytes)
      return Broken("the name of the sender is too long");
    const std::optional<std::string_view> sender = scanner.TakeBytes(*size);
    if (!sender) return NeedMore();
    name = *sender;
    hello.consumed = bytes.size() - scanner.size();
  }
  if (name.find("(recv ") != std::string_view::npos)
    return Broken("no plug-in runs in the daemon: connect without +recv; +send runs in the sender");
  hello.text = WithoutQualifiers(name);
  greeted_ = true;
  return hello;
}

YarpInput YarpReader::Frame(std::string_view bytes) {
  ByteScanner scanner(bytes);
  const std::optional<std::string_view> header = scanner.TakeBytes(kHeaderBytes);
  if (!header) return NeedMore();
  if (HeaderNumber(*header) != kIndexBytes) return Broken("a message does not begin with the index of YARP");
  const std::optional<std::string_view> index = scanner.TakeBytes(kIndexBytes);
  if (!index) return NeedMore();
  const auto blocks = static_cast<unsigned char>((*index)[0]);
  const auto replies = static_cast<unsigned char>((*index)[1]);
  ByteScanner sizes("");
  if (const auto all = scanner.TakeBytes(std::int64_t{4} * (blocks + replies))) {
    sizes = ByteScanner(*all);
  } else {
    return NeedMore();
  }
  std::int64_t total = 0;
  for (int i = 0; i < blocks; ++i) {
    const std::int32_t size = sizes.Take<std::int32_t>().value_or(-1);
    if (size < 0) return Broken("a block of a message has a negative size");
    total += size;
  }
  if (total > static_cast<std::int64_t>(kMaxRequestBytes))
    return Broken("a message is larger than " + std::to_string(kMaxRequestBytes >> 20) + " MiB");
  const std::optional<std::string_view> content = scanner.TakeBytes(total);
  if (!content) return NeedMore();

  YarpInput input{YarpInput::Kind::kCommand, bytes.size() - scanner.size()};
  ByteScanner rest(*content);
  const std::optional<std::int32_t> size = rest.Take<std::int32_t>();
  const std::optional<std::string_view> marks = rest.TakeBytes(4);
  if (!size || !marks || (*marks)[0] != '~') return Broken("a message has no command of YARP");
  if ((*marks)[1] != '\0') {
    input.text = (*marks)[1];
  } else {
    const std::optional<std::string_view> text = rest.TakeBytes(*size);
    if (!text) return Broken("the command of a message is longer than the message");
    input.text = text->substr(0, std::min(text->find('\0'), text->size()));
    SplitEnvelope(input);
  }
  input.payload = rest.rest();
  return input;
}

YarpInput YarpReader::Line(std::string_view bytes) {
  // No byte is read twice: a message in many small pieces costs no more.
  while (scanned_ < bytes.size()) {
    const char c = bytes[scanned_++];
    if (c == '\r' || c == '\0') continue;
    if (c == '\n' && !in_bottle_) {
      SplitEnvelope(line_);
      in_bottle_ = TakesBottle(line_.text);
      if (!in_bottle_) return TakeLine();
    } else if (c == '\n' && !bottle_.open()) {
      return TakeLine();
    } else if (in_bottle_) {
      bottle_.Take(c);
      line_.payload += c == '\n' ? ' ' : c;
    } else {
      line_.text += c;
    }
  }
  if (bytes.size() > kMaxRequestBytes) return Broken("a message is larger than 1 MiB");
  return NeedMore();
}

YarpInput YarpReader::TakeLine() {
  line_.kind = YarpInput::Kind::kCommand;
  line_.consumed = std::exchange(scanned_, 0);
  in_bottle_ = false;
  bottle_ = {};
  return std::exchange(line_, {});
}

std::string YarpWelcome(YarpCarrier carrier, std::string_view name, int port) {
  return IsText(carrier) ? "Welcome " + std::string(name) + "\r\n" : Header(port);
}

std::string_view YarpAck(YarpCarrier carrier) {
  constexpr std::string_view kNothingMore("YA\0\0\0\0RP", 8);
  return carrier == YarpCarrier::kTcp ? kNothingMore : carrier == YarpCarrier::kTextAck ? "<ACK>\r\n" : "";
}

std::string YarpHello(YarpCarrier carrier, std::string_view name) {
  if (IsText(carrier))
    return std::string(carrier == YarpCarrier::kText ? kConnect : kConnectAck).append(name) + "\r\n";
  const std::int32_t code = carrier == YarpCarrier::kUdp ? 0 : carrier == YarpCarrier::kTcp ? 3 + 128 : 3;
  std::string bytes = Header(kFirstCode + code);
  AppendBytes(static_cast<std::int32_t>(name.size() + 1), bytes);
  return bytes.append(name) + '\0';
}

std::optional<std::size_t> WelcomeBytes(YarpCarrier carrier, std::string_view bytes) {
  constexpr std::string_view kWelcome = "Welcome ";
  if (!IsText(carrier)) {
    if (bytes.size() < kHeaderBytes) return 0;
    return HeaderNumber(bytes.substr(0, kHeaderBytes)) ? std::optional(kHeaderBytes) : std::nullopt;
  }
  const std::size_t end = bytes.find('\n');
  if (end != std::string_view::npos && bytes.starts_with(kWelcome)) return end + 1;
  const bool may_come = end == std::string_view::npos && bytes.size() < YarpReader::kMaxNameBytes;
  return may_come ? std::optional(std::size_t{0}) : std::nullopt;
}

int WelcomePort(std::string_view welcome) {
  return HeaderNumber(welcome.substr(0, kHeaderBytes)).value_or(0);
}

void AppendYarpMessage(YarpCarrier carrier, std::string_view command, std::string_view payload,
                       std::string& out) {
  if (IsText(carrier)) {
    out.append(command) += "\r\n";
    if (!payload.empty()) out.append(payload) += "\r\n";
    return;
  }
  constexpr std::string_view kNoCharacter("~\0\0\1", 4);
  std::string head;
  if (command.size() == 1) {
    AppendBytes(std::int32_t{0}, head);
    head += {'~', command.front(), '\0', '\1'};
  } else {
    AppendBytes(static_cast<std::int32_t>(command.size() + 1), head);
    head.append(kNoCharacter).append(command) += '\0';
  }
  out += Header(kIndexBytes);
  out += payload.empty() ? '\1' : '\2';
  out += '\1';
  out.append(8, '\xff');
  AppendBytes(static_cast<std::int32_t>(head.size()), out);
  if (!payload.empty()) AppendBytes(static_cast<std::int32_t>(payload.size()), out);
  AppendBytes(std::int32_t{0}, out);
  out.append(head).append(payload);
}

}  // namespace coopdyn

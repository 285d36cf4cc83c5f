// SPDX-License-Identifier: MIT
#include "server/net/encoding.h"

#include <utility>

#include "protocol/command_ids.h"

namespace coopdyn {
namespace {

constexpr const char* kMagicText =
    "send the 4 bytes CDS1 first and then frames of protocol 1, or lines of text";

class BinaryEncoding final : public Encoding {
 public:
  Incoming Decode(std::string_view bytes) override {
    if (!std::exchange(magic_read_, true)) return {DecodeStatus::kNothing, kBinaryMagic.size()};
    Decoded decoded = DecodeBinary(bytes);
    return {decoded.status, decoded.consumed, std::move(decoded.message)};
  }
  void Reply(const Message& reply, std::string& out) override { EncodeBinary(reply, out); }
  void Push(UnaskedMessage& push, std::string& out) override { out += push.bytes(EncodeBinary); }

 private:
  bool magic_read_ = false;
};

class TextEncoding final : public Encoding {
 public:
  explicit TextEncoding(const CommandTable& table) : table_(table) {}

  Incoming Decode(std::string_view bytes) override {
    // Don't search a line that arrives byte by byte from its start each time.
    if (bytes.size() <= kMaxRequestBytes && bytes.find('\n', scanned_) == std::string_view::npos) {
      scanned_ = bytes.size();
      return {};
    }
    scanned_ = 0;
    Decoded decoded = DecodeText(bytes, table_, first_line_);
    if (decoded.consumed > 0) first_line_ = false;
    Incoming incoming{decoded.status, decoded.consumed, std::move(decoded.message)};
    if (decoded.status == DecodeStatus::kHelp) {
      incoming.answer = HelpText(table_);
    } else if (decoded.status == DecodeStatus::kVerbose) {
      verbose_ = true;
      incoming.answer = "# verbose: a line like this follows each reply\n";
    } else {
      return incoming;
    }
    incoming.status = DecodeStatus::kNothing;
    return incoming;
  }
  void Reply(const Message& reply, std::string& out) override {
    EncodeText(reply, out);
    if (verbose_) EncodeVerbose(reply, table_, out);
  }
  void Push(UnaskedMessage& push, std::string& out) override {
    out += push.bytes(EncodeText);
    if (verbose_) EncodeVerbose(*push.message(), table_, out);
  }
  bool takes_notes() const override { return verbose_; }

 private:
  const CommandTable& table_;
  std::size_t scanned_ = 0;  // bytes known to hold no '\n'
  bool first_line_ = true;
  bool verbose_ = false;
};

/// For clients that speak another protocol: sends one answer, then closes.
class Refusal final : public Encoding {
 public:
  Refusal(std::string answer, std::string why) : answer_(std::move(answer)), why_(std::move(why)) {}

  Incoming Decode(std::string_view bytes) override {
    return {DecodeStatus::kFatal, bytes.size(), ErrorReply(command::kUnreadable, Error::kMalformed, why_),
            answer_};
  }
  void Reply(const Message& /*reply*/, std::string& /*out*/) override {}
  void Push(UnaskedMessage& /*push*/, std::string& /*out*/) override {}

 private:
  const std::string answer_, why_;
};

std::unique_ptr<Encoding> RefuseMagic(const Endpoint& /*endpoint*/) {
  std::string line;
  EncodeText(ErrorReply(command::kUnreadable, Error::kMalformed, kMagicText), line);
  return std::make_unique<Refusal>(std::move(line), "CDS, but not CDS1");
}

std::unique_ptr<Encoding> RefuseHttp(const Endpoint& /*endpoint*/) {
  return std::make_unique<Refusal>(HttpRefusal(), "an HTTP request on a module's port");
}

/// Matches if SniffEncoding() returns `wanted`.
std::function<Match(std::string_view)> Sniffs(FirstBytes wanted) {
  return [wanted](std::string_view bytes) {
    const FirstBytes sniffed = SniffEncoding(bytes);
    return sniffed == wanted ? Match::kYes : sniffed == FirstBytes::kUndecided ? Match::kMaybe : Match::kNo;
  };
}

}  // namespace

const EncodingKind* Choose(const Encodings& encodings, std::string_view first_bytes) {
  for (const EncodingKind& kind : encodings) {
    const Match match = kind.match(first_bytes);
    if (match != Match::kNo) return match == Match::kYes ? &kind : nullptr;
  }
  return nullptr;
}

Encodings StandardEncodings() {
  return {{Sniffs(FirstBytes::kBinary), [](const Endpoint&) { return std::make_unique<BinaryEncoding>(); }},
          {Sniffs(FirstBytes::kWrongMagic), RefuseMagic},
          {Sniffs(FirstBytes::kHttp), RefuseHttp},
          {Sniffs(FirstBytes::kText),
           [](const Endpoint& endpoint) { return std::make_unique<TextEncoding>(endpoint.table()); }}};
}

std::string HttpRefusal() {
  const std::string body =
      "This port takes robot commands, not HTTP. The page is on the HTTP port (usually the names' port + "
      "1).\n";
  return "HTTP/1.1 400 Bad Request\r\nContent-Type: text/plain\r\nContent-Length: " +
         std::to_string(body.size()) + "\r\nConnection: close\r\n\r\n" + body;
}

}  // namespace coopdyn

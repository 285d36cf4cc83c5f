// SPDX-License-Identifier: MIT
#include "server/yarp/encoding.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/command_ids.h"
#include "server/yarp/admin.h"
#include "server/yarp/carrier.h"
#include "server/yarp/port_name.h"
#include "server/yarp/rpc.h"
#include "server/yarp/stream.h"
#include "server/yarp/translator.h"

namespace coopdyn {
namespace {

/// The program that owns `port`: "/ctl" for its ports /ctl/rpc:o, /ctl/command:o and others. Empty: unnamed.
std::string PartyOf(std::string_view port) {
  if (!port.starts_with('/')) return {};
  if (!port.ends_with(":o")) return std::string(port);
  port = port.substr(0, port.rfind('/'));
  constexpr std::string_view kYarp4 = "/nwc";
  if (port.ends_with(kYarp4)) port.remove_suffix(kYarp4.size());
  return std::string(port);
}

YarpAsker AskerOf(const Connection& asker) {
  return asker.trusted() ? YarpAsker::kTrusted : YarpAsker::kStranger;
}

constexpr int kAnyPort = 1;  // tcp's hello contains a port that nobody reads

/// A connection from a YARP program to a module.
class YarpEncoding final : public Encoding {
 public:
  YarpEncoding(const Endpoint& endpoint, YarpNetwork& network)
      : endpoint_(endpoint),
        network_(network),
        translator_(TranslatorOf(endpoint.path(), endpoint.table(), network.made())) {
    if (network.dialect()) TakeDialect(*network.dialect());
  }

  Incoming Decode(std::string_view bytes) override {
    awaited_ = Awaited::kNothing;
    YarpInput input = reader_.Next(bytes);
    using Kind = YarpInput::Kind;
    switch (input.kind) {
      case Kind::kNeedMore:
        return {};
      case Kind::kHello:
        return Hello(std::move(input));
      case Kind::kBroken:
        return Refuse(input.text, bytes.size());
      case Kind::kCommand:
        break;
    }
    Incoming incoming = Command(input);
    incoming.consumed = input.consumed;
    return incoming;
  }

  std::optional<Message> Next(const Message& reply, std::string& /*out*/) override {
    return awaited_ == Awaited::kTranslated ? translator_->Next(reply) : std::nullopt;
  }

  std::string_view party() const override { return party_; }

  void Reply(const Message& reply, std::string& out) override {
    switch (awaited_) {
      case Awaited::kUdpPort:
        if (!reply.params.empty()) out += YarpWelcome(YarpCarrier::kUdp, peer_, reply.params[0]);
        return;
      case Awaited::kVersion: {
        const bool is4 = !reply.params.empty() && reply.params[0] == 4;
        TakeDialect(is4 ? YarpDialect::k4 : YarpDialect::k3);
        out += YarpWelcome(reader_.carrier(), peer_, kAnyPort);
        return;
      }
      case Awaited::kLink:
        out += LinkAnswer(reply.error == 0, reply.text);
        return;
      case Awaited::kEnd:  // an acknowledgement would be a welcome
        return;
      case Awaited::kNothing:
      case Awaited::kModule:
      case Awaited::kTranslated:
        break;
    }
    if (wants_reply_) {
      AppendAnswer(AnswerTo(reply), out);
    } else if (awaited_ != Awaited::kNothing && !reversed_ && !warned_) {
      const std::string why = Refusal(reply);
      awaited_ = Awaited::kNothing;
      warned_ = !why.empty();
      if (warned_) network_.NoteRefused(endpoint_.path(), peer_, why);
    }
    out += ack();
  }

  void Push(UnaskedMessage& push, std::string& out) override {
    const Message& message = *push.message();
    // Only subscribers by `r`: others would mistake a push for a pending reply.
    if (!reversed_ || message.command >= command::kClosing || message.data.empty()) return;
    writer_.Append(message, reader_.carrier(), dialect_, out);
  }

 private:
  void TakeDialect(YarpDialect dialect) {
    dialect_ = dialect;
    if (translator_ != nullptr) translator_->set_dialect(dialect);
  }
  /// A translator answers only requests that it has decoded.
  YarpAnswer AnswerTo(const Message& reply) const {
    if (awaited_ == Awaited::kTranslated) return translator_->Reply(reply);
    if (translator_ != nullptr) return {BottleOf(YarpVocab{"fail"}, reply.text), {}};
    return {as_message_ ? MessageBottle(reply) : WordsBottle(reply), {}};
  }
  /// Why the request failed; empty if it succeeded.
  std::string Refusal(const Message& reply) const {
    if (awaited_ != Awaited::kTranslated) return reply.error != 0 ? reply.text : "";
    const Bottle answer = translator_->Reply(reply).bottle;
    if (WordAt(answer, 0) != "fail") return {};
    return std::string(WordAt(answer, 1));
  }
  std::string_view ack() const { return YarpAck(reader_.carrier()); }
  /// Calls `use` with the port's view of this connection.
  std::string About(const std::function<std::string(const YarpPortView&)>& use) const {
    const std::vector<YarpLink> links = network_.links().From(endpoint_.path());
    return use({endpoint_.path(), peer_, CarrierName(reader_.carrier()), links});
  }

  void AppendBottle(const Bottle& bottle, std::string& out) const {
    if (reader_.is_text()) {
      out += BottleText(bottle) + "\r\n";
    } else {
      EncodeBottle(bottle, dialect_, out);
    }
  }
  void AppendAnswer(const YarpAnswer& answer, std::string& out) const {
    if (reader_.is_text() || answer.bytes.empty()) return AppendBottle(answer.bottle, out);
    out += answer.bytes;
  }
  std::string Answer(const Bottle& bottle) const {
    std::string answer;
    AppendBottle(bottle, answer);
    return answer.append(ack());
  }
  static Incoming Done(std::string answer) {
    return {.status = DecodeStatus::kNothing, .answer = std::move(answer)};
  }

  /// Refuses all further input.
  Incoming Refuse(const std::string& why, std::size_t consumed) {
    awaited_ = Awaited::kEnd;
    Incoming incoming{DecodeStatus::kFatal, consumed,
                      ErrorReply(command::kUnreadable, Error::kMalformed, why)};
    if (reader_.is_text()) incoming.answer = why + "\r\n";
    return incoming;
  }

  Incoming Hello(YarpInput input) {
    peer_ = std::move(input.text);
    party_ = PartyOf(peer_);
    if (reader_.carrier() == YarpCarrier::kUdp) {
      awaited_ = Awaited::kUdpPort;
      // The peer closes this connection once it has the port.
      return {.status = DecodeStatus::kNothing,
              .consumed = input.consumed,
              .ask = [this](const Connection& asker, ReplyFunction reply) {
                network_.Accept(peer_, endpoint_.path(), AskerOf(asker), std::move(reply));
              }};
    }
    // The peer's requests may contain no number that shows its dialect. It is asked before the welcome,
    // because a port that waits for a reply answers no questions.
    if (!network_.dialect() && !reader_.is_text() && peer_.starts_with('/')) {
      awaited_ = Awaited::kVersion;
      return {.status = DecodeStatus::kNothing,
              .consumed = input.consumed,
              .ask = [this](const Connection& asker, ReplyFunction reply) {
                network_.AskVersion(peer_, AskerOf(asker), std::move(reply));
              }};
    }
    return {.status = DecodeStatus::kNothing,
            .consumed = input.consumed,
            .answer = YarpWelcome(reader_.carrier(), peer_, kAnyPort)};
  }

  Incoming Command(const YarpInput& input) {
    const std::string& word = input.text;
    if (reader_.carrier() == YarpCarrier::kUdp)
      return {.status = DecodeStatus::kLeave};  // it has the port now
    if (word == "d" || word == "D" || word == "do") return Request(input, word == "d");
    if (word == "<ACK>" && reversed_) return Done("");
    if (word == "a") return Administer(Read(input.payload).value_or(Bottle()));
    if (word == "q") return {.status = DecodeStatus::kLeave, .answer = std::string(ack())};
    if (!reader_.is_text()) return Done(std::string(ack()));  // as in YARP, unknown commands do nothing
    if (word == "r") return Reverse();
    if (const std::optional<YarpLinkChange> change = LinkChangeIn(word)) return ChangeLink(*change, false);
    std::string text = word == "*"                  ? About(DescribeYarpPort)
                       : word == "?" || word == "h" ? YarpHelp()
                       : word.empty()               ? ""
                                      : "Port command not understood.\r\nType d to send data to the port's "
                                        "owner.\r\nType ? for help.\r\n";
    return Done(text.append(ack()));
  }

  Incoming Administer(const Bottle& request) {
    if (const std::optional<YarpLinkChange> change = LinkChangeIn(request)) return ChangeLink(*change, true);
    return Done(About([&](const YarpPortView& port) { return Answer(AnswerYarpAdmin(request, port)); }));
  }

  Incoming ChangeLink(const YarpLinkChange& change, bool as_bottle) {
    as_bottle_ = as_bottle;
    const std::string& path = endpoint_.path();
    if (!change.adds) {
      YarpLinks& links = network_.links();
      if (links.End(path, change.to, YarpLink::Way::kOut))
        return Done(LinkAnswer(true, "Removed connection from " + path + " to " + change.to + "\r\n"));
      if (links.End(path, change.to, YarpLink::Way::kIn))
        return Done(LinkAnswer(true, "Removing connection from " + change.to + " to " + path + "\r\n"));
      return Done(LinkAnswer(false, "Could not find an outgoing connection to " + change.to +
                                        "\r\nCould not find an incoming connection from " + change.to +
                                        "\r\n"));
    }
    const std::optional<YarpStream> stream = StreamOf(path, endpoint_.table());
    if (!stream) return Done(LinkAnswer(false, path + " has no reading to send\r\n"));
    awaited_ = Awaited::kLink;
    return {.status = DecodeStatus::kNothing,
            .ask = [this, to = change.to, stream](const Connection& asker, ReplyFunction reply) {
              network_.Connect(endpoint_.path(), to, *stream, AskerOf(asker), std::move(reply));
            }};
  }

  std::string LinkAnswer(bool done, const std::string& text) const {
    return as_bottle_ ? Answer(LinkReply(done, text)) : text + std::string(ack());
  }

  Incoming Request(const YarpInput& input, bool wants_reply) {
    awaited_ = Awaited::kModule;
    wants_reply_ = wants_reply;
    as_message_ = false;
    const std::optional<Bottle> request = Read(input.payload);
    if (!request) {
      return {.status = DecodeStatus::kBad,
              .message = ErrorReply(command::kUnreadable, Error::kMalformed, "this is no Bottle of YARP")};
    }
    if (translator_ != nullptr) {
      awaited_ = Awaited::kTranslated;
      Decoded decoded = translator_->Decode(*request);
      return {
          .status = decoded.status, .message = std::move(decoded.message), .changes = translator_->changes()};
    }
    as_message_ = IsMessageBottle(*request);
    Decoded decoded = DecodeYarpRequest(*request, endpoint_.table());
    if (decoded.status == DecodeStatus::kHelp)
      return Done(wants_reply ? Answer(HelpBottle(endpoint_.table())) : std::string(ack()));
    if (decoded.status == DecodeStatus::kVerbose) {
      return {.status = DecodeStatus::kBad,
              .message = ErrorReply(command::kUnreadable, Error::kNotPossible,
                                    "verbose is for lines of text: help tells what each value is")};
    }
    if (decoded.status == DecodeStatus::kLeave)
      return {.status = DecodeStatus::kLeave,
              .answer = wants_reply ? Answer(BottleOf(YarpVocab{"bye"})) : std::string(ack())};
    if (decoded.message.command == command::kSubscribe && decoded.status == DecodeStatus::kMessage) {
      return {
          .status = DecodeStatus::kBad,
          .message = ErrorReply(command::kSubscribe, Error::kNotPossible,
                                "a connection of YARP that asks gets replies only: send r on a connection "
                                "of text, or ask for the reading each time")};
    }
    return {.status = decoded.status, .message = std::move(decoded.message)};
  }

  /// Starts to send the port's reading.
  Incoming Reverse() {
    std::optional<YarpStream> stream = StreamOf(endpoint_.path(), endpoint_.table());
    if (!stream) return Done("There is no reading to send\r\n" + std::string(ack()));
    if (stream->sample == YarpSample::kImage || stream->sample == YarpSample::kDepth)
      return Done("Pictures go to readers that are connected to this port, or by get_image\r\n" +
                  std::string(ack()));
    if (stream->sample == YarpSample::kLaserScan) stream->sample = YarpSample::kReading;
    wants_reply_ = false;
    reversed_ = true;
    awaited_ = Awaited::kModule;
    Message subscribe;
    subscribe.command = command::kSubscribe;
    subscribe.params = {stream->every, stream->reading};
    writer_.set_sample(stream->sample);
    return {.status = DecodeStatus::kMessage, .message = std::move(subscribe)};
  }

  std::optional<Bottle> Read(std::string_view payload) {
    return reader_.is_text() ? ParseBottle(payload) : DecodeBottle(payload, dialect_);
  }

  /// The source of the next reply. kTranslated: of a request that the translator has decoded.
  enum class Awaited { kNothing, kEnd, kUdpPort, kVersion, kLink, kModule, kTranslated };

  const Endpoint& endpoint_;
  YarpNetwork& network_;
  const std::unique_ptr<YarpTranslator> translator_;  // null: the port uses the module's own commands
  YarpReader reader_;
  YarpDialect dialect_ = YarpDialect::k3;  // until the peer's numbers show another
  std::string peer_, party_;
  Awaited awaited_ = Awaited::kNothing;
  bool wants_reply_ = false, as_message_ = false;  // of the last decoded request
  bool reversed_ = false;                          // readings are sent out
  bool warned_ = false;                            // a refused streamed command has been logged
  bool as_bottle_ = false;                         // answer a connection request with a Bottle
  YarpSampleWriter writer_;
};

}  // namespace

Encodings EncodingsWithYarp(YarpNetwork& network) {
  Encodings encodings = StandardEncodings();
  encodings.insert(encodings.begin(), {BeginsYarp, [&network](const Endpoint& endpoint) {
                                         return std::make_unique<YarpEncoding>(endpoint, network);
                                       }});
  return encodings;
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// The wire format of a connection's messages: one class per encoding, chosen by the client's first bytes. A
// session has only the control flow, so a new encoding is one class and one line in StandardEncodings(). No
// sockets.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/codec.h"
#include "protocol/message.h"
#include "server/net/endpoint.h"

namespace coopdyn {

/// The result of decoding received bytes.
struct Incoming {
  DecodeStatus status = DecodeStatus::kNeedMore;  // kHelp and kVerbose do not occur
  std::size_t consumed = 0;                       // bytes used up, whatever the status
  Message message = {};                           // the request, or the error reply to it
  std::string answer = {};                        // bytes to send unchanged, e.g. of a handshake
  /// Set if an object other than the endpoint serves the request. Receives this connection and a function
  /// that it must call once with the answer, on any thread, now or later; the session then calls Reply().
  /// `status` is kNothing, or kLeave: no one waits for the answer.
  std::function<void(const Connection& asker, ReplyFunction)> ask = {};
  bool changes = false;  // the request changes state, even if `message` only reads
};

/// Belongs to one connection; used only on the thread of its session.
class Encoding {
 public:
  virtual ~Encoding() = default;
  /// Called first, with this encoding's connection, which outlives it, and its endpoint. Called again with
  /// both replaced if the encoding moves to another module: see outlives_module().
  virtual void Attach(const Connection& /*connection*/, const Endpoint& /*endpoint*/) {}
  /// Bytes to send as soon as the connection has this encoding.
  virtual std::string Greeting() { return {}; }
  /// Decodes the next item of `bytes`, which begin with those not consumed before. A request may span several
  /// messages of the client. Called only after the last request has been answered.
  virtual Incoming Decode(std::string_view bytes) = 0;
  /// Appends the reply to the request decoded last, or nothing if such requests get none.
  virtual void Reply(const Message& reply, std::string& out) = 0;
  /// The next request to the endpoint before the client's request can be answered, given the `reply` to the
  /// previous one; bytes appended to `out` are sent meanwhile. Nullopt: Reply() answers the client.
  virtual std::optional<Message> Next(const Message& /*reply*/, std::string& /*out*/) { return std::nullopt; }
  /// A warning to log about `reply`, because the client cannot see it; empty: none.
  virtual std::string Warning(const Message& /*reply*/) { return {}; }
  /// Connection::party().
  virtual std::string_view party() const { return {}; }
  /// True if the client continues with the module's successor as if nothing had happened.
  virtual bool outlives_module() const { return false; }
  /// The request to repeat at the successor; nullopt: `reply`, which ends with kGoneText, is the answer.
  virtual std::optional<Message> AskedAgain(const Message& /*reply*/) { return std::nullopt; }
  /// Appends an unasked message. @pre push.message() is not null
  virtual void Push(UnaskedMessage& push, std::string& out) = 0;
  /// False while the peer must acknowledge the last unasked message: later ones wait.
  virtual bool takes_push() const { return true; }
  /// True if a person reads along: lines that begin with '#' may be sent at any time.
  virtual bool takes_notes() const { return false; }
};

/// Whether a client's first bytes select an encoding.
enum class Match { kNo, kMaybe, kYes };

struct EncodingKind {
  std::function<Match(std::string_view first_bytes)> match;
  std::function<std::unique_ptr<Encoding>(const Endpoint&)> make;  // for a connection to that endpoint
};
/// In the order of Choose().
using Encodings = std::vector<EncodingKind>;

/// The first kind that matches, if no earlier kind may still match; else null: more bytes are needed.
const EncodingKind* Choose(const Encodings& encodings, std::string_view first_bytes);

/// Binary frames, text lines, and refusals of anything that begins like one of them (docs/protocol.md,
/// "Choosing the encoding"). Text accepts everything else, so other encodings go before it.
Encodings StandardEncodings();

/// The answer to HTTP on any port but the page's: a web page must not be able to drive robots.
std::string HttpRefusal();

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// How the messages of a connection look on the wire: one class per encoding, chosen by the client's first
// bytes. A session has the flow only, so a new encoding is a class and a line in StandardEncodings(). No
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

/// What an encoding made of the bytes so far.
struct Incoming {
  DecodeStatus status = DecodeStatus::kNeedMore;  // kHelp and kVerbose do not occur
  std::size_t consumed = 0;                       // bytes that are done with, whatever the status
  Message message = {};                           // the request, or the error reply to it
  std::string answer = {};                        // bytes to send as they are, e.g. of a handshake
  /// A request of `asker`, this connection, that is not the endpoint's. Calls what it gets once, on any
  /// thread, now or later; then comes Reply(), with kNothing. With kLeave nobody waits for that.
  std::function<void(const Connection& asker, ReplyFunction)> ask = {};
  bool changes = false;  // the request is to change something, whatever `message` does first
};

/// Of one connection; the thread of its session only.
class Encoding {
 public:
  virtual ~Encoding() = default;
  /// The connection that has this encoding, and outlives it, and what it talks to. Before all else, and again
  /// when both are others: see outlives_module().
  virtual void Attach(const Connection& /*connection*/, const Endpoint& /*endpoint*/) {}
  /// What is sent as soon as the connection has this encoding.
  virtual std::string Greeting() { return {}; }
  /// Takes the next thing of `bytes`, which begin with what was not consumed before. A request may span
  /// several messages of the client. Comes only after the last request has been answered.
  virtual Incoming Decode(std::string_view bytes) = 0;
  /// Appends the reply to the request decoded last, or nothing if such requests get none.
  virtual void Reply(const Message& reply, std::string& out) = 0;
  /// What else the endpoint must do before the request is answered, after `reply` to what it was handed last;
  /// what is appended to `out` is sent meanwhile. Nothing: Reply() answers it.
  virtual std::optional<Message> Next(const Message& /*reply*/, std::string& /*out*/) { return std::nullopt; }
  /// What the log is to say of `reply`, as the client does not see it; empty: nothing.
  virtual std::string Warning(const Message& /*reply*/) { return {}; }
  /// Connection::party().
  virtual std::string_view party() const { return {}; }
  /// The client goes on with the module that takes the place of this one, as if nothing had happened.
  virtual bool outlives_module() const { return false; }
  /// What the module that takes the place of this one must be asked, as `reply`, in kGoneText, is no answer.
  virtual std::optional<Message> AskedAgain(const Message& /*reply*/) { return std::nullopt; }
  /// Appends an unasked message. @pre push.message() is not null
  virtual void Push(UnaskedMessage& push, std::string& out) = 0;
  /// False: the peer has to acknowledge the last unasked message before it gets another. Those wait.
  virtual bool takes_push() const { return true; }
  /// A person reads along: lines that begin with '#' may be sent at any time.
  virtual bool takes_notes() const { return false; }
};

/// What the first bytes of a client say about an encoding.
enum class Match { kNo, kMaybe, kYes };

struct EncodingKind {
  std::function<Match(std::string_view first_bytes)> match;
  std::function<std::unique_ptr<Encoding>(const Endpoint&)> make;  // for a connection to that endpoint
};
/// Asked in this order.
using Encodings = std::vector<EncodingKind>;

/// The first kind that says yes, if none before it may still do so; else null: more bytes must come.
const EncodingKind* Choose(const Encodings& encodings, std::string_view first_bytes);

/// Binary frames, text lines, and refusals of whatever else begins like one of them (docs/protocol.md,
/// "Choosing the encoding"). Text takes all that nobody else does, so others go before it.
Encodings StandardEncodings();

/// What a port that is not the page's answers to HTTP: a web page must not be able to drive robots.
std::string HttpRefusal();

}  // namespace coopdyn

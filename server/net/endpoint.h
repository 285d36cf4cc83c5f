// SPDX-License-Identifier: MIT
// The session's view of a module, free of sockets: one endpoint per module. All calls happen on the one
// thread that runs the endpoint's io_context.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/smart_ptr/make_local_shared.hpp>

#include "protocol/command_table.h"
#include "protocol/message.h"
#include "server/base/ids.h"
#include "server/base/input_end.h"

namespace coopdyn {

/// An unasked message for any number of connections: composed when the first of them can send it, and encoded
/// once for all.
class UnaskedMessage {
 public:
  /// Returns nullopt if there is nothing to say after all. Everything it uses lives as long as the endpoint.
  using Make = std::function<std::optional<Message>()>;

  explicit UnaskedMessage(Message message) : message_(std::move(message)) {}
  explicit UnaskedMessage(Make make) : make_(std::move(make)) {}

  /// Null if there is nothing to say.
  const Message* message() {
    if (make_) message_ = std::exchange(make_, nullptr)();
    return message_ ? &*message_ : nullptr;
  }
  /// The message as `encode` writes it, encoded once for all connections. @pre message() is not null
  const std::string& bytes(void (*encode)(const Message&, std::string&)) {
    for (const Encoded& encoded : encoded_) {
      if (encoded.by == encode) return encoded.bytes;
    }
    Encoded& encoded = encoded_.emplace_back(Encoded{encode, {}});
    encode(*message_, encoded.bytes);
    return encoded.bytes;
  }

 private:
  struct Encoded {
    void (*by)(const Message&, std::string&);
    std::string bytes;
  };

  Make make_;  // null once message_ is composed
  std::optional<Message> message_;
  std::vector<Encoded> encoded_;
};
using UnaskedPtr = boost::local_shared_ptr<UnaskedMessage>;  // one thread: counted without atomics

/// A client's live connection as an endpoint sees it.
class Connection {
 public:
  virtual ~Connection() = default;
  virtual ClientId id() const = 0;
  virtual const std::string& peer() const = 0;  // "127.0.0.1:53120", or "page"
  /// Connections of one party act as one client: each may drive what any of them owns. Empty: a party of one.
  virtual std::string_view party() const { return {}; }
  /// True for loopback and connections from inside the daemon: these need no token.
  virtual bool trusted() const = 0;
  /// The client has shut down its sending side (or died: they look alike).
  virtual bool input_ended() const = 0;
  /// Lets any thread detect the end of input, possibly before input_ended(); also reports it once the daemon
  /// has begun to close the connection. Null if not available.
  virtual std::shared_ptr<InputEnd> input_end() const { return nullptr; }
  /// True if the client is gone or reads nothing more: an endpoint need not compute answers for it.
  virtual bool output_ended() const = 0;
  /// Queues an unasked message. At most 64 wait; beyond that the oldest is dropped, and the next one's text
  /// begins with `dropped N`. `dropped`: number of messages already lost before this one. The message may be
  /// composed later, even after OnClosed(), as long as the endpoint lives. Returns false if the client
  /// accepts nothing now; OnTakesMore() follows when it does.
  virtual bool Push(const UnaskedPtr& message, std::int64_t dropped) = 0;
  /// Sends a closing notice (command −1, `reason`), then closes the connection.
  virtual void Close(const std::string& reason) = 0;
};

using ReplyFunction = std::function<void(Message)>;

/// Suffix of error 5 from an endpoint that is about to be replaced, or whose connections are about to close.
inline constexpr std::string_view kGoneText = " is no longer part of the scenario";

class Endpoint {
 public:
  virtual ~Endpoint() = default;
  /// "/robot1/motors"
  virtual const std::string& path() const = 0;
  /// The module's commands, for the text codec, help and describe.
  virtual const CommandTable& table() const = 0;
  virtual void OnOpen(Connection&) {}
  /// Handles one well-formed request. Calls `reply` exactly once, on this thread, now or later; the session
  /// passes its next request only after that. A reply to a closed connection is dropped silently.
  virtual void OnRequest(Connection& connection, Message request, ReplyFunction reply) = 0;
  /// The client reads again after a pause.
  virtual void OnTakesMore(Connection&) {}
  /// End of input. Complete requests already received still arrive through OnRequest(); OnClosed() follows.
  virtual void OnInputEnded(Connection&) {}
  /// The last call about this connection.
  virtual void OnClosed(Connection&) {}
  /// Another client that drives this module's robot; empty if none does.
  virtual std::string DriverBeside(const Connection& /*connection*/) const { return {}; }
  /// Name of whom a pending request waits for, for `verbose`; empty if unknown.
  virtual std::string WaitingFor() { return {}; }
};

}  // namespace coopdyn

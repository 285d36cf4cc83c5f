// SPDX-License-Identifier: MIT
// What a session talks to, free of sockets: one endpoint per module. All calls happen on the one thread that
// runs the endpoint's io_context.
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

/// An unasked message, for any number of connections: made when the first of them can take it, and encoded
/// once for all.
class UnaskedMessage {
 public:
  /// Gives nothing if there is nothing to say after all. What it uses lives as long as the endpoint.
  using Make = std::function<std::optional<Message>()>;

  explicit UnaskedMessage(Message message) : message_(std::move(message)) {}
  explicit UnaskedMessage(Make make) : make_(std::move(make)) {}

  /// Null: there is nothing to say.
  const Message* message() {
    if (make_) message_ = std::exchange(make_, nullptr)();
    return message_ ? &*message_ : nullptr;
  }
  /// As `encode` writes it, which is done once for all connections. @pre message() is not null
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

  Make make_;  // null: made
  std::optional<Message> message_;
  std::vector<Encoded> encoded_;
};
using UnaskedPtr = boost::local_shared_ptr<UnaskedMessage>;  // of one thread: counted without atomics

/// A client's live connection as an endpoint sees it.
class Connection {
 public:
  virtual ~Connection() = default;
  virtual ClientId id() const = 0;
  virtual const std::string& peer() const = 0;  // "127.0.0.1:53120", or "page"
  /// Connections of one party act as one client: what one of them owns the others drive, too. Empty: it is
  /// alone.
  virtual std::string_view party() const { return {}; }
  /// From loopback or from inside the daemon: needs no token.
  virtual bool trusted() const = 0;
  /// The client has shut down its sending side (or died: they look alike).
  virtual bool input_ended() const = 0;
  /// By which any thread sees that, maybe earlier; also if the daemon has begun to close it. Null: none can.
  virtual std::shared_ptr<InputEnd> input_end() const { return nullptr; }
  /// The client is gone or takes nothing more: an endpoint need not compute answers for it.
  virtual bool output_ended() const = 0;
  /// Sends an unasked message. At most 64 wait; then the oldest is dropped and the next one says `dropped N`;
  /// `dropped`: how many more there would have been before this one. It may be made later, even after
  /// OnClosed(), as long as the endpoint lives. False: it waits, as the client takes nothing now;
  /// OnTakesMore() follows when it does.
  virtual bool Push(const UnaskedPtr& message, std::int64_t dropped) = 0;
  /// Sends a closing notice (command −1, `reason`), then closes once it is written.
  virtual void Close(const std::string& reason) = 0;
};

using ReplyFunction = std::function<void(Message)>;

/// Ends the text of error 5 of an endpoint that another one replaces soon, or whose connections end.
inline constexpr std::string_view kGoneText = " is no longer part of the scenario";

class Endpoint {
 public:
  virtual ~Endpoint() = default;
  /// "/robot1/motors"
  virtual const std::string& path() const = 0;
  /// The module's commands: the text codec, help and describe read them.
  virtual const CommandTable& table() const = 0;
  virtual void OnOpen(Connection&) {}
  /// Handles one request (already well-formed). Calls `reply` exactly once, on this thread, now or later; a
  /// session hands over its next request only after that. A reply to a connection that is gone is dropped
  /// silently.
  virtual void OnRequest(Connection& connection, Message request, ReplyFunction reply) = 0;
  /// The client reads again after it took nothing for a while.
  virtual void OnTakesMore(Connection&) {}
  /// End of input. Complete requests already received still come through OnRequest(), then OnClosed()
  /// follows.
  virtual void OnInputEnded(Connection&) {}
  /// The last call about this connection.
  virtual void OnClosed(Connection&) {}
  /// Another client that drives what this is a module of; empty: none does.
  virtual std::string DriverBeside(const Connection& /*connection*/) const { return {}; }
  /// Whom a waiting request waits for, for `verbose`; empty if nothing is known.
  virtual std::string WaitingFor() { return {}; }
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// The name server's protocol: one request line in, the reply out. Supports YARP's plain-text name protocol,
// the same without its prefix for people, and OPEN. No sockets; any thread.
//
//   NAME_SERVER query /robot1/motors      registration name /robot1/motors ip 127.0.0.1 port 10002 type tcp
//                                         *** end of message
//   OPEN /robot1/motors                   ok                  (then the connection is the module's)
//   OPEN /robot1/moters                   error 10 no such name /robot1/moters; did you mean /robot1/motors
//
// A refused request is answered `*** refused: WHY` and the end line.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "server/naming/name_table.h"

namespace coopdyn {

/// Hooks into the rest of the daemon, called on the name server's thread.
struct NameHooks {
  /// Opens one of our ports that exist only on demand, if `name` is one. `asker`: the asker's address.
  std::function<void(const std::string& name, const std::string& asker)> open;
  /// Makes the port `from` start or stop sending to `to`.
  std::function<void(const Subscription& subscription, bool connects)> connect;
};

/// The asker and the place it asked.
struct NameContext {
  std::string asked_at;    // the address that the request reached
  std::string peer_ip;     // of the asker
  std::string advertise;   // address of our own names in every answer; empty: asked_at
  Nanoseconds now = 0;     // by the daemon's clock
  bool read_only = false;  // names may not be added or removed
  const NameHooks* hooks = nullptr;
};

struct NameReply {
  std::string text;         // to be sent first
  AdoptFunction open = {};  // then receives the connection; null: none
  std::string opened = {};  // the name that is opened
  bool close = false;       // close the connection after `text`
};

/// Answers one request. `line` has no end of line; a trailing '\r' is ignored.
NameReply AnswerNameLine(std::string_view line, const NameContext& context, NameTable& table);

/// The name within an address with a carrier: "/clock" for "tcp://clock".
std::string NameInAddress(std::string_view address);

/// The answer to a module's binary magic at the name port.
NameReply AnswerMagic(const NameTable& table);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// The words of the name server: one request line in, the reply out. YARP's plain-text name protocol, the same
// without its prefix for people, and OPEN. No sockets; any thread.
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

/// What the rest of the daemon does for the name server, on its thread.
struct NameHooks {
  /// Opens a name of ours that is there only when somebody asks for it, if there is such a one. `asker`: its
  /// address.
  std::function<void(const std::string& name, const std::string& asker)> open;
  /// Tells the port `from` to send to `to` from now on, or no longer.
  std::function<void(const Subscription& subscription, bool connects)> connect;
};

/// Who asks, and where.
struct NameContext {
  std::string asked_at;    // the address that the request reached
  std::string peer_ip;     // of the asker
  std::string advertise;   // the address of our own names in every answer; empty = asked_at
  Nanoseconds now = 0;     // by the daemon's clock
  bool read_only = false;  // no name may come or go
  const NameHooks* hooks = nullptr;
};

struct NameReply {
  std::string text;         // to be sent
  AdoptFunction open = {};  // then the connection goes here
  std::string opened = {};  // under this name
  bool close = false;       // then the connection is closed
};

/// Answers one request. `line` has no end of line; a trailing '\r' does not matter.
NameReply AnswerNameLine(std::string_view line, const NameContext& context, NameTable& table);

/// The name in an address with a carrier: "tcp://clock" is /clock.
std::string NameInAddress(std::string_view address);

/// The answer to a module's binary magic on the name port.
NameReply AnswerMagic(const NameTable& table);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Ports that YARP's own devices have: their requests, in the words of these devices, become messages to a
// module. Pure.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/codec.h"
#include "protocol/command_table.h"
#include "protocol/message.h"
#include "server/yarp/bottle.h"

namespace coopdyn {

class YarpMadeThings;

/// What goes back for a request.
struct YarpAnswer {
  Bottle bottle = {};
  std::string bytes = {};  // if not empty, instead of the bottle where it would be binary
};

/// Of one connection; one request at a time.
class YarpTranslator {
 public:
  virtual ~YarpTranslator() = default;
  /// The peer's version of YARP, before the first request if it is known.
  virtual void set_dialect(YarpDialect /*dialect*/) {}
  /// kMessage, or kBad with the reason.
  virtual Decoded Decode(const Bottle& request) = 0;
  /// Whether the request decoded last is to change something, whatever its first message does.
  virtual bool changes() const { return false; }
  /// After `reply`, also an error, to the message before: what else the module must do before the request is
  /// answered. Nothing: Reply() answers it.
  virtual std::optional<Message> Next(const Message& /*reply*/) { return std::nullopt; }
  /// The answer to the request decoded last, from the last reply.
  virtual YarpAnswer Reply(const Message& reply) = 0;
};

/// The answer to getRemoteProtocolVersion, which clients of YARP 4 ask first.
YarpAnswer YarpProtocolVersion();
/// For a port of a module with these commands. Null: the port speaks the words of its module.
/// `made`: what the world interface has made, for all its connections.
std::unique_ptr<YarpTranslator> TranslatorOf(std::string_view port, const CommandTable& table,
                                             std::shared_ptr<YarpMadeThings> made = nullptr);

}  // namespace coopdyn

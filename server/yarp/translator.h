// SPDX-License-Identifier: MIT
// Translates requests to ports of YARP's own devices into messages to a module. Pure.
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

/// The answer to a request.
struct YarpAnswer {
  Bottle bottle = {};
  std::string bytes = {};  // if not empty, replaces the bottle on binary carriers
};

/// Belongs to one connection; one request at a time.
class YarpTranslator {
 public:
  virtual ~YarpTranslator() = default;
  /// The peer's YARP version, set before the first request if known.
  virtual void set_dialect(YarpDialect /*dialect*/) {}
  /// Returns kMessage, or kBad with the reason.
  virtual Decoded Decode(const Bottle& request) = 0;
  /// Whether the last decoded request changes state, even if its first message only reads.
  virtual bool changes() const { return false; }
  /// The module's next message before the request can be answered, given the `reply` (or error) to the
  /// previous one. Nullopt: Reply() answers the request.
  virtual std::optional<Message> Next(const Message& /*reply*/) { return std::nullopt; }
  /// The answer to the last decoded request, from the last reply.
  virtual YarpAnswer Reply(const Message& reply) = 0;
};

/// The answer to getRemoteProtocolVersion, the first request of YARP 4 clients.
YarpAnswer YarpProtocolVersion();
/// The translator for a port of a module with this command table. Null: the port uses the module's own
/// commands. `made`: the things made through the world interface, shared by all its connections.
std::unique_ptr<YarpTranslator> TranslatorOf(std::string_view port, const CommandTable& table,
                                             std::shared_ptr<YarpMadeThings> made = nullptr);

}  // namespace coopdyn

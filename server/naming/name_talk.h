// SPDX-License-Identifier: MIT
// The name server as a YARP port, with YARP's text carriers: `d`, then a request on its own line. YARP's
// programs subscribe this way. No sockets; one connection's thread.
//
//   CONNACK admin                                   Welcome admin
//   d
//   subscribe "tcp://clock" "tcp://me/clock:i"      [ok]
//                                                   <ACK>
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/naming/name_protocol.h"

namespace coopdyn {

class NameTalk {
 public:
  /// Nullopt if `line` does not begin such a connection.
  static std::optional<NameTalk> Begin(std::string_view line);
  /// The answer to the first line.
  std::string Welcome() const { return "Welcome " + name_ + "\r\n"; }
  /// The answer to the next line.
  NameReply Answer(std::string_view line, const NameContext& context, NameTable& table);

 private:
  enum class Expects { kCommand, kRequest, kRequestWithoutReply, kAdministration };
  NameTalk(std::string name, bool acknowledges) : name_(std::move(name)), acknowledges_(acknowledges) {}
  NameReply AnswerCommand(std::string_view command);
  NameReply Acknowledged(std::string text) const;

  std::string name_;  // the peer's name for itself
  bool acknowledges_;
  Expects expects_ = Expects::kCommand;
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// The JSON that the page and scripts send and receive: docs/protocol.md. Pure; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <boost/json/value.hpp>

#include "protocol/message.h"
#include "server/state/image_board.h"
#include "server/web/people.h"

namespace coopdyn {

/// A message for a module:
/// {"id":1,"module":"/robot1/motors","command":"set_velocity","params":[],"data":[0.2,0.5],"text":""}, or
/// {"id":1,"module":"/robot1/motors","line":"set_velocity 0.2 0.5"}.
struct PageCall {
  boost::json::value id;  // repeated in the reply: a number, a string or null
  std::string module;     // "/robot1/motors"; a missing leading '/' is added
  /// Calls of one module and channel share a connection: the module reads the next after answering the last.
  std::string channel;
  std::optional<std::string> line;  // as typed; command_name and message are then empty
  std::string command_name;         // empty: message.command is the number
  Message message;
  std::string token;
};

/// {"type":"hello","token":"T"}: gives a WebSocket its rights.
struct PageHello {
  std::string token;
};

/// {"type":"view","width":640,"height":480,"eye":[x,y,z],"look":[x,y,z],"rays":false}: starts pictures from
/// this camera; without width, stops them. A message {"type":"shown"} asks for the next one.
struct PageView {
  std::optional<ImageRequest> request;
};
struct PageShown {};

/// {"type":"poses","rate":30}: starts the bodies' poses (pose_stream.h), at most 30 a second; 0 stops them.
struct PagePoses {
  static constexpr double kMaxRate_hz = 60;
  double rate_hz = 0;
};

/// {"type":"sensors","rate":15}: likewise starts what sensors show (sensor_message.h).
struct PageSensors {
  double rate_hz = 0;
};

/// {"type":"close","module":"/robot1/motors","channel":""}: closes that connection, which frees the robot.
struct PageClose {
  std::string module;
  std::string channel;
};

using PageMessage =
    std::variant<PageCall, PageHello, PageView, PageShown, PagePoses, PageSensors, PageClose, PageMe>;

/// A message, or the error in it.
struct PageRead {
  std::optional<PageMessage> message;
  std::string error;      // with what to write instead
  boost::json::value id;  // of the message, even a bad one; null if unreadable
};
PageRead ReadPageMessage(std::string_view json);

/// A module's reply or push, as sent to the page.
struct PageReply {
  std::optional<boost::json::value> id;  // none: a push, `"push":true` instead
  std::string module;
  std::string channel;
  Message message;
  std::string line;                  // the reply in the text encoding, for the console
  std::string note;                  // its explanation, for the console
  std::optional<Message> sent = {};  // the message that a line was read as, for "copy as code"
};
/// {"id":1,"module":"…","error":0,"text":"","command":11,"params":[0],"data":[0.01,1]}; non-finite numbers
/// are the strings "inf", "-inf", "nan".
std::string WritePageReply(const PageReply& reply);

}  // namespace coopdyn

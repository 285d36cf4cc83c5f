// SPDX-License-Identifier: MIT
// The JSON that the page and scripts send, and that they get: docs/protocol.md. Pure; any thread.
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
  /// Calls of one module and channel share a connection, so the next is read when the last was answered.
  std::string channel;
  std::optional<std::string> line;  // as a person types it; the rest is then empty
  std::string command_name;         // or message.command
  Message message;
  std::string token;
};

/// {"type":"hello","token":"T"}: gives a WebSocket its rights.
struct PageHello {
  std::string token;
};

/// {"type":"view","width":640,"height":480,"eye":[x,y,z],"look":[x,y,z],"rays":false}: pictures from here,
/// please. Without width: no more pictures. A message {"type":"shown"} asks for the next one.
struct PageView {
  std::optional<ImageRequest> request;
};
struct PageShown {};

/// {"type":"poses","rate":30}: where the bodies are (pose_stream.h), at most this often a second; 0: no more.
struct PagePoses {
  static constexpr double kMaxRate_hz = 60;
  double rate_hz = 0;
};

/// {"type":"close","module":"/robot1/motors","channel":""}: closes that connection, which frees the robot.
struct PageClose {
  std::string module;
  std::string channel;
};

using PageMessage = std::variant<PageCall, PageHello, PageView, PageShown, PagePoses, PageClose, PageMe>;

/// What could be read, or what is wrong with it.
struct PageRead {
  std::optional<PageMessage> message;
  std::string error;      // says what to write instead
  boost::json::value id;  // of the bad message, as far as it could be read
};
PageRead ReadPageMessage(std::string_view json);

/// A module's reply or push as the page gets it.
struct PageReply {
  std::optional<boost::json::value> id;  // none: a push, `"push":true` instead
  std::string module;
  std::string channel;
  Message message;
  std::string line;  // the reply as the text encoding has it, and its explanation; for the console
  std::string note;
  std::optional<Message> sent = {};  // what a line meant, so that the page can say it in other languages
};
/// {"id":1,"module":"…","error":0,"text":"","command":11,"params":[0],"data":[0.01,1]}; numbers that are not
/// finite are the strings "inf", "-inf", "nan".
std::string WritePageReply(const PageReply& reply);

}  // namespace coopdyn

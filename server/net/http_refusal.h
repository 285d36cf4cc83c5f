// SPDX-License-Identifier: MIT
// What a port that is not the page's answers to HTTP: a web page must not be able to drive robots. Pure; any
// thread.
#pragma once

#include <string>

namespace coopdyn {

inline std::string HttpRefusal() {
  const std::string body =
      "This port takes robot commands, not HTTP. The page is on the HTTP port (usually the names' port + "
      "1).\n";
  return "HTTP/1.1 400 Bad Request\r\nContent-Type: text/plain\r\nContent-Length: " +
         std::to_string(body.size()) + "\r\nConnection: close\r\n\r\n" + body;
}

}  // namespace coopdyn

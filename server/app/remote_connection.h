// SPDX-License-Identifier: MIT
// A plain blocking connection to a running daemon, for the commands that talk to one. One thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "protocol/message.h"

namespace coopdyn {

/// HOST[:PORT] in its parts: "lab:10100", "[::1]:10000", "10.0.0.5"; nothing if the port is not a number.
struct ServerAddress {
  std::string host = "127.0.0.1";
  int port = 10000;
};
std::optional<ServerAddress> ParseServerAddress(const std::string& text);

/// Errors are texts that say what is wrong and what to do; empty: all is well.
class RemoteConnection {
 public:
  RemoteConnection() = default;
  ~RemoteConnection();
  RemoteConnection(const RemoteConnection&) = delete;
  RemoteConnection& operator=(const RemoteConnection&) = delete;

  /// Connects to the name port; gives up after 3 s.
  std::string Connect(const ServerAddress& server);
  /// Sends one line to the name server and returns the lines of its answer, without the end line.
  std::string AskNames(const std::string& line, std::vector<std::string>& answer);
  /// Turns this connection into one of module `name`. A token is shown by `hello` if not empty.
  std::string Open(const std::string& name);
  /// Binary from the first Call on: sends `request`, waits for its reply.
  std::string Call(const Message& request, Message& reply);
  /// Text from the first CallLine on: sends `line`, waits for the reply line.
  std::string CallLine(const std::string& line, std::string& reply);

 private:
  std::string Send(const std::string& bytes);
  /// Reads some more bytes into buffer_.
  std::string Receive();
  std::string ReadLine(std::string& line);

  int fd_ = -1;
  bool binary_started_ = false;
  std::string buffer_;  // received, not yet used
};

}  // namespace coopdyn

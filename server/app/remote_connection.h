// SPDX-License-Identifier: MIT
// A plain blocking connection to a running daemon, for the commands that talk to one. One thread.
#pragma once

#include <CLI/CLI.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "protocol/message.h"

namespace coopdyn {

/// A command that talks to a daemon ends with this exit code and text.
struct RemoteError : std::runtime_error {
  RemoteError(int exit_code, const std::string& text) : std::runtime_error(text), code(exit_code) {}
  int code;
};

/// Where the daemon is.
struct ServerOptions {
  std::string server;  // HOST[:PORT]; empty: this machine, port 10000
  std::string token;
};
/// Adds --server and --token to a command. The result lives as long as somebody holds it.
std::shared_ptr<ServerOptions> AddServerOptions(CLI::App& command);

/// "lab:10100", "[::1]:10000", "10.0.0.5", "10100" or "" in its parts. Throws RemoteError.
struct ServerAddress {
  explicit ServerAddress(const std::string& text);
  std::string host = "127.0.0.1";
  int port = 10000;
};

/// Each function throws RemoteError with a text that says what is wrong and what to do.
class RemoteConnection {
 public:
  /// Connects to the name port; gives up after 3 s, and 10 s later if it does not answer to a name.
  explicit RemoteConnection(const ServerAddress& server);

  /// Sends one line to the name server and returns the lines of its answer, without the end line.
  std::vector<std::string> AskNames(const std::string& line);
  /// Turns this connection into one of module `name`.
  void Open(const std::string& name);
  /// Binary from the first Call on: sends `request`, waits for its reply.
  Message Call(const Message& request);
  /// Text from the first CallLine on: sends `line`, waits for the reply line.
  std::string CallLine(const std::string& line);
  /// The # lines that answer a line which nothing else answers: help, verbose, an empty one.
  std::string AskComments(const std::string& line);

 private:
  void Send(const std::string& bytes);
  std::string ReadLine();
  /// Why nothing more comes.
  RemoteError NoAnswer() const;
  static RemoteError Unreadable();

  boost::asio::ip::tcp::iostream stream_;
  bool binary_started_ = false;
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// A blocking connection to a running daemon, for client commands. One thread.
#pragma once

#include <CLI/CLI.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "protocol/message.h"

namespace coopdyn {

/// Ends a client command with this exit code and text.
struct RemoteError : std::runtime_error {
  RemoteError(int exit_code, const std::string& text) : std::runtime_error(text), code(exit_code) {}
  int code;
};

/// The daemon's address and token.
struct ServerOptions {
  std::string server;  // HOST[:PORT]; empty: this machine, port 10000
  std::string token;
  std::string seat;  // of a class, NAME:PIN; empty: none
};
/// Adds --server, --token and --seat to a command.
std::shared_ptr<ServerOptions> AddServerOptions(CLI::App& command);

/// Parses "lab:10100", "[::1]:10000", "10.0.0.5", "10100" or "", and the seat "ana:7305" or "". Throws
/// RemoteError.
struct ServerAddress {
  explicit ServerAddress(const std::string& text, const std::string& seat = "");
  std::string host = "127.0.0.1";
  int port = 10000;
  std::string seat_line;  // what takes the seat, "SEAT ana 7305"; empty: no seat
};

/// All functions throw RemoteError with a text that says what is wrong and what to do.
class RemoteConnection {
 public:
  /// Connects to the name port, and takes the seat. Times out after 3 s; requests to the name server time out
  /// 10 s later, of a seat, whose daemon may have to start, 30 s.
  explicit RemoteConnection(const ServerAddress& server);

  /// Sends one line to the name server and returns the lines of its answer, without the end line.
  std::vector<std::string> AskNames(const std::string& line);
  /// Turns this connection into a connection to module `name`.
  void Open(const std::string& name);
  /// Sends `request` and waits for its reply. Binary from the first Call() on.
  Message Call(const Message& request);
  /// Sends `line` and waits for the reply line. Text from the first CallLine() on.
  std::string CallLine(const std::string& line);
  /// Returns the # lines that answer a line without a reply line: help, verbose, an empty line.
  std::string AskComments(const std::string& line);

 private:
  void TakeSeat(const ServerAddress& server);
  void Send(const std::string& bytes);
  std::string ReadLine();
  /// The error for a missing answer.
  RemoteError NoAnswer() const;
  static RemoteError Unreadable();

  boost::asio::ip::tcp::iostream stream_;
  bool binary_started_ = false;
};

}  // namespace coopdyn

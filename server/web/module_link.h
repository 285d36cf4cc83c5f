// SPDX-License-Identifier: MIT
// The client side of one module connection inside the daemon: a socket pair whose other end the module
// adopts. Uses the binary encoding. UI thread.
#pragma once

#include <utility>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "protocol/message.h"
#include "server/naming/name_table.h"

namespace coopdyn {

class ModuleLink : public std::enable_shared_from_this<ModuleLink> {
 public:
  using ReplyFunction = std::function<void(const Message& reply)>;
  /// Called for unsolicited messages; the closing notice is the last.
  using PushFunction = std::function<void(const Message& push)>;

  /// Unsent requests; beyond this limit Call() answers error 8.
  static constexpr std::size_t kMaxOutgoingBytes = std::size_t{40} << 20;

  /// Null if `entry` belongs to another program or no socket pair can be opened.
  static std::shared_ptr<ModuleLink> Open(boost::asio::io_context& context, const NameEntry& entry,
                                          PeerInfo peer);
  ~ModuleLink();

  void set_push_function(PushFunction function) { on_push_ = std::move(function); }
  /// Sends a request and later calls `reply` once, unless Close() comes first. If the module closes the
  /// connection, `reply` receives error 5 with the reason.
  void Call(const Message& request, ReplyFunction reply);
  /// Closes the connection, which frees the robot it owns. No callback runs afterwards.
  void Close();
  /// Closes the connection and later answers pending requests with error 5 and `reason`.
  void Abandon(const std::string& reason);
  bool is_open() const { return open_; }
  /// Requests not yet answered.
  std::size_t waiting() const { return replies_.size(); }

 private:
  struct Waiting {
    std::int32_t command = 0;
    ReplyFunction reply;
  };

  explicit ModuleLink(boost::asio::io_context& context) : socket_(context) {}
  void Read();
  void TakeMessages();
  void Deliver(const Message& message);
  void Write();
  /// Closes the connection after the module has, and answers all pending requests.
  void Fail();

  boost::asio::local::stream_protocol::socket socket_;
  bool open_ = true;
  std::array<char, 16384> chunk_;
  std::string incoming_;
  std::string outgoing_;  // sent after writing_
  std::string writing_;
  bool write_pending_ = false;
  std::deque<Waiting> replies_;
  PushFunction on_push_;
  std::string closing_reason_;
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// One connection to the name server: lines in, answers out, one after the other; OPEN gives it away. Io
// thread only.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>

#include "server/naming/name_protocol.h"
#include "server/naming/name_table.h"
#include "server/net/net_services.h"
#include "server/net/peer.h"

namespace coopdyn {

class NameSession : public std::enable_shared_from_this<NameSession> {
 public:
  using Socket = boost::asio::generic::stream_protocol::socket;
  static constexpr std::size_t kMaxLineBytes = 4096;

  /// `on_end` is called when the socket is closed or given away.
  NameSession(Socket socket, NameTable& table, NetServices& services, PeerInfo peer, NameContext context,
              std::function<void()> on_end);
  void Start() { Read(); }
  /// Closes at once. No on_end.
  void Abort();

 private:
  using ErrorCode = boost::system::error_code;

  void Read();
  void OnRead(const ErrorCode& error, std::size_t count);
  void AnswerLines();
  void Take(NameReply reply);
  void Write();
  void AfterWrite();
  void GiveAway();
  void Linger();
  void End();

  Socket socket_;
  NameTable& table_;
  NetServices& services_;
  const PeerInfo peer_;
  NameContext context_;
  std::function<void()> on_end_;
  boost::asio::steady_timer linger_timer_;
  std::string in_;
  std::string out_;
  char block_[1024];
  AdoptFunction open_;
  std::string opened_;
  bool first_bytes_ = true;
  bool close_ = false;      // after out_ is written
  bool lingering_ = false;  // all is written: waiting for the peer to close
  bool ended_ = false;
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// The yardstick of lockstep: a blocking server of one connection that computes the same step inline (physics,
// all distances, the target) and answers with the same number of bytes, without any part of the daemon.
#pragma once

#include <string>
#include <thread>

namespace coopdyn {

class EchoServer {
 public:
  /// `spin_us`: polling time for the next request before blocking.
  explicit EchoServer(int spin_us);
  /// Joins the thread; close the connection first.
  ~EchoServer();
  int port() const { return port_; }

 private:
  int listener_ = -1;
  int port_ = 0;
  std::thread thread_;
};

/// Receives exactly `size` bytes, polling for `spin_us` before it blocks. False at the end of the stream.
bool ReceiveExactly(int fd, char* bytes, std::size_t size, int spin_us);

/// A TCP connection to a port of this machine, without delay. Exits on failure.
int ConnectTo(int port);
void SendAll(int fd, const std::string& bytes);

}  // namespace coopdyn

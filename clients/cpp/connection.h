// SPDX-License-Identifier: MIT
// One connection to one module. One thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clients/cpp/address.h"
#include "clients/cpp/bulk_reader.h"
#include "protocol/message.h"

namespace coopdyn::client {

/// While a reply is under way the connection is `busy`: it is closed and opened again rather than used for
/// anything else, since reading on would take the next reply for the one that is missing.
class Connection {
 public:
  /// `drives`: says the plain client name (Address::HelloText). `address` outlives it.
  Connection(const Address& address, std::string module, bool drives);
  /// The connection of a program's team of this number: large replies are read without a copy.
  Connection(const Address& address, std::string module, int team_number);
  ~Connection() { Close(); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  const std::string& module() const { return module_; }
  bool is_open() const { return fd_ >= 0; }
  bool busy() const { return busy_; }
  int fd() const { return fd_; }

  /// Opens (again) and says hello. Throws Error.
  void Open();
  void Close();
  /// False if closed, in use, or closed by the peer meanwhile.
  bool Alive();
  /// Writes a request. Throws Closed.
  void Send(std::int32_t command, std::vector<std::int32_t> params, std::span<const double> data,
            std::string text = "");
  /// The reply if it has come, error replies included; readings pushed before it go to `pushes`. Throws
  /// Closed.
  std::optional<Message> TryRead();
  /// Waits for the reply; polls for `spin_s` before it blocks. Throws Error 11 after `timeout_s`, and Closed.
  Message Receive(double timeout_s, double spin_s);
  /// Sends a request and returns its reply. Throws an error reply as Error.
  Message Request(std::int32_t command, std::vector<std::int32_t> params = {},
                  std::span<const double> data = {}, std::string text = "", double timeout_s = 10,
                  double spin_s = 0);
  /// Of a team's connection: memory for the data of a later reply.
  void Recycle(std::vector<double> values) { bulk_->Recycle(std::move(values)); }
  /// Ends the sending side after what was sent, so that nothing of it is lost.
  void FinishSending();
  /// Waits until the daemon has answered all and closed, at most until `deadline` of the steady clock.
  void AwaitEnd(std::chrono::steady_clock::time_point deadline);

  std::deque<Message> pushes;

 private:
  std::optional<Message> TryReadBulk();

  const Address& address_;
  std::string module_;
  bool drives_;
  int number_ = 1;
  std::optional<BulkReader> bulk_;
  int fd_ = -1;
  bool busy_ = false;
  std::string in_, out_;
  Message request_;  // kept for its capacity
};

/// Throws an error reply, with `who` before its text. A WorldReset with one word if a reset or load has ended
/// the wait: Session::NewWorld() makes it a text.
Message Checked(Message reply, const std::string& who = "");

}  // namespace coopdyn::client

// SPDX-License-Identifier: MIT
// One connection to one module. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clients/cpp/address.h"
#include "clients/cpp/polling.h"
#include "protocol/message.h"

namespace coopdyn::client {

inline constexpr const char* kLoad = "load";                    // error text if a load ended a wait
inline constexpr const char* kPlaying = "playing a recording";  // start of an error text
inline constexpr int kLockstep = 1;                             // a mode
inline constexpr double kRequestTimeout_s = 10;                 // of requests that are answered immediately
inline constexpr double kLoadTimeout_s = 60;  // of requests that build a world or close a file
inline constexpr double kCloseGrace_s = 0.2;  // for the daemon to read the last commands

/// A request to a module, and the timeout of its reply.
struct Request {
  std::int32_t command = 0;
  std::vector<std::int32_t> params = {};
  std::vector<double> data = {};
  std::string text = {};
  double timeout_s = kRequestTimeout_s;
};

/// While a reply is pending, the connection is `busy`. To give the reply up, close and reopen the connection:
/// otherwise the late reply would be mistaken for the next one.
class Connection {
 public:
  /// `drives`: sends the plain client name; a team's connection also sends `team_number`
  /// (Address::HelloText). `address` must outlive the connection.
  Connection(const Address& address, std::string module, bool drives, int team_number = 1);

  const std::string& module() const { return module_; }
  /// Sets the module that Open() connects to.
  void set_module(std::string module) { module_ = std::move(module); }
  bool is_open() const { return socket_.fd() >= 0; }
  bool busy() const { return busy_; }
  int fd() const { return socket_.fd(); }

  /// (Re)opens the connection and sends hello. Throws Error.
  void Open();
  void Close();
  /// False if closed, busy, or meanwhile closed by the peer.
  bool Alive();
  /// Opens the connection unless Alive().
  void KeepOpen();
  /// Writes a request. Throws Closed.
  void Send(std::int32_t command, std::vector<std::int32_t> params = {}, std::span<const double> data = {},
            std::string text = "");
  /// Returns the reply if it has arrived, including error replies; appends readings pushed before it to
  /// `pushes`. Throws Closed, and Error 7 for malformed bytes.
  std::optional<Message> TryRead();
  /// Waits for the reply; if `polling` is not null, polls before blocking. Throws Closed, and Error 11 after
  /// `timeout_s`.
  Message Receive(double timeout_s, Polling* polling);
  /// Sends a request and returns its reply. Throws an error reply as Error.
  Message Ask(Request request, Polling* polling = nullptr);
  /// Shuts down the sending side; no sent bytes are lost.
  void FinishSending();
  /// Waits until the daemon has answered everything and closed, at most until `deadline`.
  void AwaitEnd(Deadline deadline);

  std::deque<Message> pushes;

 private:
  std::optional<Message> Decode();

  const Address& address_;
  std::string module_;
  bool drives_;
  int team_number_;
  Socket socket_;
  bool busy_ = false;
  std::string in_;        // received bytes, and room for more
  std::size_t have_ = 0;  // number of received bytes in in_
  std::string out_;
  Message request_;  // kept for its capacity
};

/// Throws an error reply, with `who` before its text. If a reset or load ended the wait, throws WorldReset
/// with a one-word text, which Session::NewWorld() turns into a message.
Message Checked(Message reply, const std::string& who = "");
/// Throws Error 7 if a reply has fewer params than `params`, or fewer data than `data` before the final two.
void Require(const Message& reply, std::size_t params, std::size_t data);
/// The final two data of a reply: time [s] and step. @pre Require(reply, 0, 0)
double TimeOf(const Message& reply);
std::int64_t StepOf(const Message& reply);

}  // namespace coopdyn::client

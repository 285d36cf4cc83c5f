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

inline constexpr const char* kLoad = "load";                    // what an error says that ends a wait
inline constexpr const char* kPlaying = "playing a recording";  // how an error begins
inline constexpr int kLockstep = 1;                             // a mode
inline constexpr double kRequestTimeout_s = 10;                 // for what is answered at once
inline constexpr double kLoadTimeout_s = 60;                    // for what builds a world or closes a file
inline constexpr double kFarewell_s = 0.2;                      // for the daemon to read what is sent last

/// What a module is asked, and how long to wait for its reply.
struct Request {
  std::int32_t command = 0;
  std::vector<std::int32_t> params = {};
  std::vector<double> data = {};
  std::string text = {};
  double timeout_s = kRequestTimeout_s;
};

/// While a reply is under way the connection is `busy`: it is closed and opened again rather than used for
/// anything else, since reading on would take the next reply for the one that is missing.
class Connection {
 public:
  /// `drives`: says the plain client name; the connection of a program's team says its number, too
  /// (Address::HelloText). `address` outlives it.
  Connection(const Address& address, std::string module, bool drives, int team_number = 1);

  const std::string& module() const { return module_; }
  /// The one that Open() opens from now on.
  void set_module(std::string module) { module_ = std::move(module); }
  bool is_open() const { return socket_.fd() >= 0; }
  bool busy() const { return busy_; }
  int fd() const { return socket_.fd(); }

  /// Opens (again) and says hello. Throws Error.
  void Open();
  void Close();
  /// False if closed, in use, or closed by the peer meanwhile.
  bool Alive();
  /// Opens it unless it is Alive().
  void KeepOpen();
  /// Writes a request. Throws Closed.
  void Send(std::int32_t command, std::vector<std::int32_t> params = {}, std::span<const double> data = {},
            std::string text = "");
  /// The reply if it has come, error replies included; readings pushed before it go to `pushes`. Throws
  /// Closed, and Error 7 for what is no message.
  std::optional<Message> TryRead();
  /// Waits for the reply; polls before it blocks, if there is a `polling`. Throws Error 11 after `timeout_s`,
  /// and Closed.
  Message Receive(double timeout_s, Polling* polling);
  /// Sends a request and returns its reply. Throws an error reply as Error.
  Message Ask(Request request, Polling* polling = nullptr);
  /// Ends the sending side after what was sent, so that nothing of it is lost.
  void FinishSending();
  /// Waits until the daemon has answered all and closed, at most until `deadline`.
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
  std::string in_;        // what has come, and room for more
  std::size_t have_ = 0;  // bytes of it that have come
  std::string out_;
  Message request_;  // kept for its capacity
};

/// Throws an error reply, with `who` before its text. A WorldReset with one word if a reset or load has ended
/// the wait: Session::NewWorld() makes it a text.
Message Checked(Message reply, const std::string& who = "");
/// Throws Error 7 if a reply has fewer params than its command promises, or fewer data before the final two.
void Require(const Message& reply, std::size_t params, std::size_t data);
/// The final two data of a reply: time [s] and step. @pre Require(reply, 0, 0)
double TimeOf(const Message& reply);
std::int64_t StepOf(const Message& reply);

}  // namespace coopdyn::client

// SPDX-License-Identifier: MIT
// The port of a class for programs. A connection begins with a line that says whose seat it wants:
//
//   SEAT ana 7305            ok
//   SEAT ana 7305 python     ok                        (the language of the program, for the wall)
//   SEAT ana 1234            error 12 wrong PIN for ana
//
// and goes on as on the port of any daemon. The io_context's thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "server/base/wrong_tokens.h"
#include "server/host/class_room.h"
#include "server/net/listener.h"

namespace coopdyn {

/// The words of the first line.
struct SeatLine {
  std::string seat, pin, language;
};
/// Nothing: it is no such line.
std::optional<SeatLine> ReadSeatLine(std::string_view line);

/// Judges who may have which seat, and slows down who tries PINs. The io_context's thread.
class SeatGuard {
 public:
  /// All outlive it.
  SeatGuard(const ClassRoom& room, const Clock& clock, WrongTokens& wrong)
      : room_(room), clock_(clock), wrong_(wrong) {}
  /// Empty: `peer` may have the seat. Otherwise why not.
  std::string Judge(std::string_view seat, std::string_view pin, const std::string& peer);

 private:
  const ClassRoom& room_;
  const Clock& clock_;
  WrongTokens& wrong_;
};

class FrontDoor {
 public:
  static constexpr std::size_t kMaxLine = 256;
  /// How long a client may take to say its line.
  static constexpr std::chrono::seconds kLineTime{15};
  /// Connections that have not said it yet; of more, the oldest of the address with the most is closed.
  static constexpr std::size_t kMaxGuests = 256;

  /// All outlive it.
  FrontDoor(boost::asio::io_context& context, ClassRoom& room, SeatGuard& guard, NetServices& services);
  ~FrontDoor();
  FrontDoor(const FrontDoor&) = delete;
  FrontDoor& operator=(const FrontDoor&) = delete;

  /// Listener::Listen().
  std::string Listen(const std::vector<std::string>& addresses, int port);
  int port() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace coopdyn

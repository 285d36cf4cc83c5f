// SPDX-License-Identifier: MIT
// One HTTP request to the page of a seat's daemon, over a pair of sockets of which the daemon gets one. The
// io_context's thread.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include <boost/asio/io_context.hpp>

#include "server/host/seat.h"

namespace coopdyn {

/// What the page answered; status 0: nothing came.
struct SeatAnswer {
  unsigned status = 0;
  std::string body;
};

/// The longest answer that is read.
inline constexpr std::uint64_t kMaxSeatAnswer = std::uint64_t{512} << 20;

/// Sends `body` (none: GET) to `target` of the page of a seat that runs, as the teacher. `done` is called
/// once.
void CallSeat(boost::asio::io_context& context, Seat& seat, const std::string& target,
              const std::string& body, std::function<void(SeatAnswer)> done,
              std::chrono::seconds time = std::chrono::seconds(10));

}  // namespace coopdyn

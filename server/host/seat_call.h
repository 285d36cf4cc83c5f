// SPDX-License-Identifier: MIT
// Sends an HTTP request to the page of a seat's daemon, over a socket pair whose other end is passed to the
// daemon. The io_context's thread.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include <boost/asio/io_context.hpp>

#include "server/host/seat.h"

namespace coopdyn {

/// The page's reply; status 0: no reply.
struct SeatAnswer {
  unsigned status = 0;
  std::string body;
};

/// Longest accepted reply.
inline constexpr std::uint64_t kMaxSeatAnswer = std::uint64_t{512} << 20;

/// Sends `body` (empty: GET) to `target` of a running seat's page, as the teacher. Calls `done` once, after
/// at most `time`.
void CallSeat(boost::asio::io_context& context, Seat& seat, const std::string& target,
              const std::string& body, std::function<void(SeatAnswer)> done,
              std::chrono::seconds time = std::chrono::seconds(10));

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// The pages of a class over HTTP: the login, the wall, and what a student's page asks the host. What belongs
// to a seat's daemon, /s/NAME/..., is passed to it with its socket. The io_context's thread.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "server/host/class_room.h"
#include "server/host/front_door.h"
#include "server/net/listener.h"

namespace coopdyn {

class ClassPages {
 public:
  static constexpr std::uint32_t kMaxHeaderBytes = 16 << 10;
  static constexpr std::uint64_t kMaxBodyBytes = 1 << 20;
  static constexpr std::chrono::seconds kRequestTime{15};
  /// Connections whose request is read or answered; of more, the oldest of the address with the most is
  /// closed.
  static constexpr std::size_t kMaxGuests = 512;
  /// Those of all seats and of one, or of the wall, that wait for events, hand in or collect.
  static constexpr std::size_t kMaxWaiting = 4096, kMaxWaitingOfOne = 16;

  /// `token`: of the wall. `host_names`: as in WebOptions. `wrong` counts wrong tokens. All outlive it.
  ClassPages(boost::asio::io_context& context, ClassRoom& room, SeatGuard& guard, std::string token,
             std::vector<std::string> host_names, WrongTokens& wrong, const Clock& clock,
             NetServices& services);
  ~ClassPages();
  ClassPages(const ClassPages&) = delete;
  ClassPages& operator=(const ClassPages&) = delete;

  /// Listener::Listen().
  std::string Listen(const std::vector<std::string>& addresses, int port);
  int port() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace coopdyn

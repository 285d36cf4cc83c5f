// SPDX-License-Identifier: MIT
// Which of many sockets can be read: one level-triggered epoll per io_context. A socket is registered once,
// so that a request costs one recv and one send; Asio's own reading costs a second, failing recv each time.
#pragma once

#include <sys/epoll.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include <boost/asio/execution_context.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "server/net/unique_fd.h"

namespace coopdyn {

/// What is told that its socket is ready.
class SocketHandler {
 public:
  virtual ~SocketHandler() = default;
  /// `events` as of epoll. May change its own interest and those of others.
  virtual void OnReady(std::uint32_t events) = 0;
};

/// A service of its io_context, run by the IoThread of that. Its thread only.
class SocketPoller final : public boost::asio::execution_context::service {
 public:
  using key_type = SocketPoller;
  static inline boost::asio::execution_context::id id;
  /// Sockets handled in a row; then timers and posted work have their turn.
  static constexpr std::size_t kBatch = 128;

  static SocketPoller& Of(boost::asio::io_context& context) {
    return boost::asio::use_service<SocketPoller>(context);
  }
  /// Throws std::system_error if the machine has no descriptor left.
  explicit SocketPoller(boost::asio::execution_context& context);

  /// From now on `handler` is told of `events` (EPOLLIN, EPOLLOUT) of `fd`; 0: of nothing, not even of its
  /// end. `before` is what it was told of until now. Returns false if the kernel refuses.
  bool Change(int fd, SocketHandler& handler, std::uint32_t before, std::uint32_t events);
  /// Tells of up to kBatch sockets that are ready now; returns of how many.
  std::size_t Poll();
  /// The next socket that is ready ends io_context::run_one(), which then has done Poll().
  void Arm();

 private:
  void shutdown() override;

  UniqueFd epoll_;
  std::optional<boost::asio::posix::stream_descriptor> event_;  // epoll_, as Asio sees it
  bool armed_ = false;
  std::array<epoll_event, kBatch> ready_{};
  std::size_t next_ = 0, count_ = 0;  // of ready_: still to be told
};

}  // namespace coopdyn

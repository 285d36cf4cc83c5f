// SPDX-License-Identifier: MIT
#include "server/net/socket_poller.h"

#include <cerrno>
#include <system_error>

namespace coopdyn {
namespace {

namespace asio = boost::asio;

UniqueFd MakeEpoll() {
  UniqueFd epoll(::epoll_create1(EPOLL_CLOEXEC));
  if (!epoll) throw std::system_error(errno, std::generic_category(), "epoll_create1");
  return epoll;
}

}  // namespace

SocketPoller::SocketPoller(asio::execution_context& context)
    : service(context), epoll_(MakeEpoll()), event_(std::in_place, static_cast<asio::io_context&>(context)) {
  event_->assign(epoll_.get());
}

void SocketPoller::shutdown() {
  event_->release();
  event_.reset();
  epoll_.Reset();
}

bool SocketPoller::Change(int fd, SocketHandler& handler, std::uint32_t before, std::uint32_t events) {
  if (before == events) return true;
  if (!epoll_) return false;
  epoll_event event{};
  event.events = events;
  event.data.ptr = &handler;
  const int what = before == 0 ? EPOLL_CTL_ADD : events == 0 ? EPOLL_CTL_DEL : EPOLL_CTL_MOD;
  if (::epoll_ctl(epoll_.get(), what, fd, &event) != 0) return false;
  // It may be gone by the time that its turn comes.
  for (std::size_t i = next_; events == 0 && i < count_; ++i) {
    if (ready_[i].data.ptr == &handler) ready_[i].data.ptr = nullptr;
  }
  return true;
}

void SocketPoller::Arm() {
  if (std::exchange(armed_, true)) return;
  event_->async_wait(asio::posix::stream_descriptor::wait_read,
                     [this](const boost::system::error_code& error) {
                       armed_ = false;
                       if (!error) Poll();
                     });
}

std::size_t SocketPoller::Poll() {
  const int ready = ::epoll_wait(epoll_.get(), ready_.data(), static_cast<int>(ready_.size()), 0);
  // If a handler throws, epoll tells again of those that were not told.
  next_ = 0;
  count_ = ready > 0 ? static_cast<std::size_t>(ready) : 0;
  while (next_ < count_) {
    const epoll_event event = ready_[next_++];
    if (event.data.ptr != nullptr) static_cast<SocketHandler*>(event.data.ptr)->OnReady(event.events);
  }
  return count_;
}

}  // namespace coopdyn

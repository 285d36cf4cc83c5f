// SPDX-License-Identifier: MIT
#include "server/host/front_door.h"

#include <sys/socket.h>

#include <utility>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>

#include "server/base/printable.h"
#include "server/base/words.h"
#include "server/host/crowd.h"
#include "server/net/await.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Socket = asio::generic::stream_protocol::socket;

constexpr std::size_t kReadAtOnce = 4096;
constexpr const char* kNoSeatLine =
    "error 12 this is a class, where each student has a seat: begin with SEAT NAME PIN; a program says "
    "connect(seat=\"ana\", pin=\"7305\"), or COOPDYN_SEAT=ana:7305\n";

}  // namespace

std::optional<SeatLine> ReadSeatLine(std::string_view line) {
  const std::vector<std::string> words = SplitWords(line.substr(0, line.find('\r')));
  if (words.size() < 3 || words.size() > 4 || words[0] != "SEAT") return std::nullopt;
  return SeatLine{words[1], words[2], words.size() > 3 ? words[3] : ""};
}

std::string SeatGuard::Judge(std::string_view seat, std::string_view pin, const std::string& peer) {
  const Nanoseconds now = clock_.Now();
  const std::string what = "seat " + Printable(seat, 40);
  if (std::string wait = wrong_.WaitText(peer, now, what); !wait.empty()) return wait;
  const RollEntry* const entry = room_.roll().Find(seat);
  const bool right = entry != nullptr && TokenGuard(entry->pin, true).Matches(pin);
  if (wrong_.Judge(right, peer, now, what) == TokenVerdict::kRight) return {};
  // One text for both, so that nobody finds out who is in the class.
  return "no seat '" + Printable(seat, 40) +
         "' with this PIN: both stand on the sheet that the teacher hands out";
}

struct FrontDoor::Impl : std::enable_shared_from_this<FrontDoor::Impl> {
  Impl(asio::io_context& c, ClassRoom& r, SeatGuard& g, NetServices& s)
      : context(c), room(r), guard(g), services(s), listener(c, s, [this](UniqueFd fd, PeerInfo peer) {
          Open(std::move(fd), std::move(peer));
        }) {}

  void Open(UniqueFd fd, PeerInfo peer) {
    const auto guest = std::make_shared<Socket>(context);
    error_code failed;
    guest->assign({AF_UNSPEC, 0}, fd.get(), failed);
    if (failed) return;
    fd.Release();
    const Crowd::Ticket ticket = guests.Enter(NetworkOf(peer.text), [guest] {
      error_code ignored;
      guest->close(ignored);
    });
    asio::co_spawn(context, Serve(guest, std::move(peer)),
                   [weak = weak_from_this(), guest, ticket](const std::exception_ptr& thrown) {
                     if (const auto impl = weak.lock()) impl->guests.Leave(ticket);
                     error_code ignored;
                     guest->close(ignored);
                     if (thrown) std::rethrow_exception(thrown);  // the thread logs it
                   });
  }

  asio::awaitable<void> Serve(std::shared_ptr<Socket> guest, PeerInfo peer) {
    asio::steady_timer patience(context, kLineTime);
    patience.async_wait([guest](const error_code& aborted) {
      error_code ignored;
      if (!aborted) guest->close(ignored);
    });
    std::string in;
    char block[kReadAtOnce];
    std::size_t end = std::string::npos;
    while ((end = in.find('\n')) == std::string::npos && in.size() <= kMaxLine && !in.starts_with("CDS")) {
      const auto [ended, count] = co_await guest->async_read_some(asio::buffer(block), kAwait);
      if (ended) co_return;
      in.append(block, count);
    }
    const std::optional<SeatLine> line =
        end == std::string::npos ? std::nullopt : ReadSeatLine(std::string_view(in).substr(0, end));
    std::string refusal = line ? guard.Judge(line->seat, line->pin, peer.text) : std::string();
    if (const Seat* const failed = line && refusal.empty() ? room.FindSeat(line->seat) : nullptr;
        failed != nullptr && failed->HasFailed())
      refusal = failed->trouble();
    const std::string answer = !line ? kNoSeatLine : refusal.empty() ? "ok\n" : "error 12 " + refusal + "\n";
    const auto [failed, written] = co_await asio::async_write(*guest, asio::buffer(answer), kAwait);
    if (failed || !guest->is_open()) co_return;
    Seat* const seat = line && refusal.empty() ? room.FindSeat(line->seat) : nullptr;  // it may have gone
    if (seat == nullptr) {
      error_code ignored;
      guest->shutdown(Socket::shutdown_send, ignored);
      co_await guest->async_read_some(asio::buffer(block), kAwait);  // so that the answer arrives
      co_return;
    }
    patience.cancel();
    room.NoteActive(line->seat, peer.text, line->language);
    services.LogPeer(spdlog::level::debug, peer.text, "takes the seat " + line->seat);
    peer.trusted = true;
    peer.yields = true;
    PassedSocket passed{
        .kind = PassedKind::kNames, .peer = std::move(peer), .already_read = in.substr(end + 1)};
    error_code lost;
    passed.fd = UniqueFd(guest->release(lost));
    if (!lost) seat->Pass(std::move(passed));
  }

  asio::io_context& context;
  ClassRoom& room;
  SeatGuard& guard;
  NetServices& services;
  Listener listener;
  Crowd guests{kMaxGuests, kMaxGuests};  // who have not said their line, by network
};

FrontDoor::FrontDoor(asio::io_context& context, ClassRoom& room, SeatGuard& guard, NetServices& services)
    : impl_(std::make_shared<Impl>(context, room, guard, services)) {}

FrontDoor::~FrontDoor() {
  impl_->guests.Clear();
}

std::string FrontDoor::Listen(const std::vector<std::string>& addresses, int port) {
  return impl_->listener.Listen(addresses, port);
}

int FrontDoor::port() const {
  return impl_->listener.port();
}

}  // namespace coopdyn

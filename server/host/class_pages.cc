// SPDX-License-Identifier: MIT
#include "server/host/class_pages.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <functional>
#include <optional>
#include <sstream>
#include <utility>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/readable_pipe.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "protocol/json_text.h"
#include "server/base/spawn.h"
#include "server/base/words.h"
#include "server/host/class_routes.h"
#include "server/host/crowd.h"
#include "server/host/json_fields.h"
#include "server/host/program_requests.h"
#include "server/host/sheet.h"
#include "server/net/await.h"
#include "server/web/access.h"
#include "server/web/assets.h"
#include "server/web/http_routes.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace json = boost::json;
using boost::system::error_code;
using Request = http::request<http::string_body>;

constexpr std::chrono::milliseconds kEventsEvery{500};
constexpr unsigned kPassed = 0, kLater = 1;  // instead of a status of HTTP
constexpr int kHeartbeat = 30;               // pauses without an event
constexpr std::chrono::seconds kDrainTime{2}, kCollectTime{600};
constexpr const char* kStudents = "students.csv";  // who has which seat, for the archive
constexpr const char* kWallCookie = "coopdyn_wall";

std::string SeatCookie(const std::string& seat) {
  return "coopdyn_" + seat;
}

HttpAnswer WithCookie(HttpAnswer answer, const std::string& name, const std::string& value,
                      const std::string& path) {
  answer.headers.emplace_back("Set-Cookie",
                              name + "=" + value + "; Path=" + path + "; HttpOnly; SameSite=Strict");
  return answer;
}

HttpAnswer HtmlAnswer(std::string page) {
  HttpAnswer answer;
  answer.body = std::move(page);
  answer.type = "text/html; charset=utf-8";
  answer.headers.emplace_back("Cache-Control", "no-store");
  return answer;
}

HttpAnswer GoTo(const std::string& where) {
  return {.status = 303, .headers = {{"Location", where}, {"Cache-Control", "no-store"}}};
}

}  // namespace

struct ClassPages::Impl : std::enable_shared_from_this<ClassPages::Impl> {
  /// A connection that is ours.
  struct Guest {
    explicit Guest(asio::ip::tcp::socket socket) : stream(std::move(socket)) {}
    beast::tcp_stream stream;
    PeerInfo peer;
    bool waits = false;  // for what takes longer
    Crowd::Ticket ticket = 0;
    beast::flat_buffer buffer = {};
    std::optional<http::request_parser<http::string_body>> parser = {};
  };
  using GuestPtr = std::shared_ptr<Guest>;

  Impl(asio::io_context& c, ClassRoom& r, SeatGuard& g, std::string t, std::vector<std::string> n,
       WrongTokens& w, const Clock& k, NetServices& s)
      : context(c),
        room(r),
        guard(g),
        teacher(std::move(t), true, &w),
        host_names(std::move(n)),
        clock(k),
        listener(c, s, [this](UniqueFd fd, PeerInfo peer) { Open(std::move(fd), std::move(peer)); }) {}

  void Open(UniqueFd fd, PeerInfo peer) {
    asio::ip::tcp::socket socket(context);
    error_code failed;
    const bool v4 = PeerAddress(fd.get()).ip.find(':') == std::string::npos;
    socket.assign(v4 ? asio::ip::tcp::v4() : asio::ip::tcp::v6(), fd.get(), failed);
    if (failed) return;
    fd.Release();
    const auto guest = std::make_shared<Guest>(std::move(socket));
    guest->peer = std::move(peer);
    guest->ticket = guests.Enter(NetworkOf(guest->peer.text), [guest] { guest->stream.close(); });
    asio::co_spawn(context, Serve(guest), [weak = weak_from_this(), guest](const std::exception_ptr& thrown) {
      if (const auto impl = weak.lock()) (guest->waits ? impl->waiting : impl->guests).Leave(guest->ticket);
      guest->stream.close();
      if (thrown) std::rethrow_exception(thrown);  // the thread logs it
    });
  }

  /// One request; each answer ends its connection, as the next request may be for another seat. (No
  /// temporaries in expressions that await: GCC 12 destroys some of them twice.)
  asio::awaitable<void> Serve(GuestPtr guest) {
    auto& parser = guest->parser.emplace();
    parser.header_limit(kMaxHeaderBytes);
    parser.body_limit(kMaxBodyBytes);
    guest->stream.expires_after(kRequestTime);
    const auto [failed, header] =
        co_await http::async_read_header(guest->stream, guest->buffer, parser, kAwait);
    if (failed) co_return;
    HttpAnswer answer;
    const ClassRoute route = FindClassRoute(parser.get().target());
    if (const std::string why = Objection(parser.get()); !why.empty()) {
      answer = ErrorAnswer(403, why);
    } else if (route.kind == ClassRouteKind::kSeat || route.kind == ClassRouteKind::kWallSeat) {
      answer = PassOn(*guest, route);
      if (answer.status == kPassed) co_return;
    } else {
      const auto [lost, body] = co_await http::async_read(guest->stream, guest->buffer, parser, kAwait);
      if (lost && lost != http::error::body_limit) co_return;
      answer = lost ? ErrorAnswer(413, "at most 1 MiB") : Judge(*guest, route);
      if (answer.status == 200 && answer.body.empty()) answer = Handle(*guest, route);
    }
    if (answer.status == kLater) {
      guests.Leave(guest->ticket);
      guest->waits = true;
      guest->ticket = waiting.Enter(route.seat, [guest] { guest->stream.close(); });
      const Later later = LaterOf(route);
      if (later == Later::kEvents) co_return co_await Stream(guest, route);
      if (later == Later::kArchive) co_return co_await Collect(guest);
      const std::string error = co_await HandIn(route);
      answer = error.empty() ? JsonAnswer("{}") : ErrorAnswer(500, error);
    }
    co_await Answer(guest, answer);
  }

  /// Guards against pages of others: of names that somebody else's DNS resolves to us, and of other origins.
  std::string Objection(const Request& request) const {
    const auto hosts = request.equal_range(http::field::host);
    const bool one = hosts.first != hosts.second && std::next(hosts.first) == hosts.second;
    const std::string_view host = one ? std::string_view(hosts.first->value()) : std::string_view();
    if (!one || !HostAllowed(host, host_names))
      return "this host is not known by that name: use its address, or start it with --host NAME";
    const std::string_view origin = request[http::field::origin];
    if (!origin.empty() && !OriginAllowed(origin, host)) return "requests from another page are refused";
    if (request.method() != http::verb::post) return {};
    const std::string_view type = request[http::field::content_type];
    return type.starts_with("application/json") ? "" : "send JSON: Content-Type: application/json";
  }

  bool IsTeacher(const Request& request) const {
    const std::string_view cookie = CookieIn(request[http::field::cookie], kWallCookie);
    const std::string_view bearer = BearerToken(request[http::field::authorization]);
    return teacher.Matches(cookie) || teacher.Matches(bearer);
  }

  /// Empty: the request may have the seat.
  std::string WhyNotStudent(const Guest& guest, const std::string& seat) const {
    const Request& request = guest.parser->get();
    const RollEntry* const entry = room.roll().Find(seat);
    if (entry != nullptr &&
        TokenGuard(entry->link, true).Matches(CookieIn(request[http::field::cookie], SeatCookie(seat))))
      return {};
    const std::string_view bearer = BearerToken(request[http::field::authorization]);  // a program: ana:7305
    const std::size_t colon = bearer.find(':');
    if (colon == std::string_view::npos || bearer.substr(0, colon) != seat)
      return "this seat is another student's, or you are not logged in: go to / and enter name and PIN";
    return guard.Judge(seat, bearer.substr(colon + 1), guest.peer.text);
  }

  /// Passes the connection to the seat's daemon. Status kPassed: done.
  HttpAnswer PassOn(Guest& guest, const ClassRoute& route) {
    Request& request = guest.parser->get();
    const bool teaches = route.kind == ClassRouteKind::kWallSeat;
    const std::string prefix = std::string(teaches ? "/wall" : "") + "/s/" + route.seat;
    Seat* const seat = room.FindSeat(route.seat);
    if (teaches && !IsTeacher(request))
      return ErrorAnswer(403, "this needs the teacher's token: go to /wall/");
    if (!teaches) {
      if (const std::string why = WhyNotStudent(guest, route.seat); !why.empty()) {
        const bool page = route.rest.empty() || route.rest == "/";
        return page && request.method() == http::verb::get ? GoTo("/") : ErrorAnswer(403, why);
      }
    }
    if (seat == nullptr) return ErrorAnswer(404, "there is no seat " + route.seat);
    if (seat->HasFailed()) return ErrorAnswer(503, seat->trouble());
    if (route.rest.empty()) return GoTo(prefix + "/");
    // What the wall and open pages ask by themselves starts no seat, nor again one that ends just now.
    const bool wakes = route.rest.find("?wake=no") == std::string::npos;
    if (!wakes && (seat->put_aside() || seat->state() != SeatState::kRunning)) return {.status = 204};
    // Each request is judged here, so the daemon ends the connection with its answer.
    request.target(route.rest);
    if (!beast::websocket::is_upgrade(request)) request.set(http::field::connection, "close");
    request.erase(http::field::cookie);
    request.erase(http::field::authorization);
    std::ostringstream head;
    head << request.base();
    if (!teaches && (request.method() == http::verb::post || beast::websocket::is_upgrade(request)))
      room.NoteActive(route.seat, guest.peer.text);
    PassedSocket passed{.kind = PassedKind::kPage, .peer = guest.peer};
    passed.already_read = head.str() + beast::buffers_to_string(guest.buffer.data());
    passed.peer.trusted = true;
    passed.peer.yields = !teaches;
    error_code failed;
    passed.fd = UniqueFd(guest.stream.release_socket().release(failed));
    if (failed) return {.status = kPassed};
    seat->Pass(std::move(passed));
    return {.status = kPassed};
  }

  /// Whether the guest may ask for that: status 200 without a body.
  HttpAnswer Judge(const Guest& guest, const ClassRoute& route) const {
    if (route.kind == ClassRouteKind::kSeatAsks || route.kind == ClassRouteKind::kProgram) {
      const std::string why = WhyNotStudent(guest, route.seat);
      return why.empty() ? HttpAnswer() : ErrorAnswer(403, why);
    }
    const bool stranger =
        (route.kind == ClassRouteKind::kWallAsks || route.kind == ClassRouteKind::kWallProgram) &&
        !IsTeacher(guest.parser->get());
    if (stranger && route.rest == "sheet") return GoTo("/wall/#to=sheet");
    return stranger ? ErrorAnswer(403, "this needs the teacher's token") : HttpAnswer();
  }

  /// The answer; kLater: it takes longer.
  HttpAnswer Handle(const Guest& guest, const ClassRoute& route) {
    const Request& request = guest.parser->get();
    const bool post = request.method() == http::verb::post;
    switch (route.kind) {
      case ClassRouteKind::kAsset:
        return AssetAnswer(route.rest, request);
      case ClassRouteKind::kLink:
        return LinkAnswer(route.rest);
      case ClassRouteKind::kLogin:
      case ClassRouteKind::kWallLogin:
        if (!post) return ErrorAnswer(405, "this address takes POST only");
        return route.kind == ClassRouteKind::kLogin ? Login(guest) : WallLogin(guest);
      case ClassRouteKind::kSeatAsks:
        return HandleStudent(request, route);
      case ClassRouteKind::kWallAsks:
        return HandleTeacher(request, route.rest);
      case ClassRouteKind::kProgram:
      case ClassRouteKind::kWallProgram:
        return HandleProgram(guest, route);
      case ClassRouteKind::kUnknown:
      case ClassRouteKind::kSeat:
      case ClassRouteKind::kWallSeat:
        break;
    }
    return ErrorAnswer(404, "there is nothing at this address");
  }

  HttpAnswer LinkAnswer(const std::string& link) const {
    const RollEntry* const entry = room.FindLink(link);
    if (entry == nullptr)
      return ErrorAnswer(404, "this link is no longer valid: ask your teacher for another");
    const std::string path = "/s/" + entry->seat + "/";
    return WithCookie(GoTo(path), SeatCookie(entry->seat), entry->link, path);
  }

  HttpAnswer AssetAnswer(const std::string& path, const Request& request) const {
    if (path == "/wall") return GoTo("/wall/");
    const Asset* const asset = FindAsset(path);
    if (asset == nullptr) return ErrorAnswer(404, "there is nothing at this address");
    return AnswerAsset(*asset, std::string_view(request[http::field::if_none_match]),
                       std::string_view(request[http::field::accept_encoding]));
  }

  HttpAnswer Login(const Guest& guest) const {
    const json::object said = ObjectIn(guest.parser->get().body());
    const std::string name(Trim(TextIn(said, "name"))), pin(Trim(TextIn(said, "pin")));
    const RollEntry* const known = room.roll().FindNamed(name, pin);
    const std::string seat = known == nullptr ? name : known->seat;
    if (std::string why = guard.Judge(seat, pin, guest.peer.text); !why.empty()) return ErrorAnswer(403, why);
    const std::string path = "/s/" + seat + "/";
    return WithCookie(JsonAnswer(json::serialize(json::object{{"go", path}})), SeatCookie(seat), known->link,
                      path);
  }

  HttpAnswer WallLogin(const Guest& guest) const {
    const std::string token = TextIn(ObjectIn(guest.parser->get().body()), "token");
    if (std::string wait = teacher.WaitText(guest.peer.text, clock.Now()); !wait.empty())
      return ErrorAnswer(403, wait);
    if (teacher.Judge(token, guest.peer.text, clock.Now()) != TokenVerdict::kRight)
      return ErrorAnswer(403, "this is not the teacher's token: coopdyn host printed it when it started");
    return WithCookie(JsonAnswer("{}"), kWallCookie, token, "/wall/");
  }

  HttpAnswer HandleStudent(const Request& request, const ClassRoute& route) {
    const bool post = request.method() == http::verb::post;
    if (!post && route.rest == "me") return JsonAnswer(json::serialize(room.StudentJson(route.seat)));
    if (post == (route.rest == "hand-in") && (post || route.rest == "events")) return {.status = kLater};
    if (!post || route.rest != "hand")
      return ErrorAnswer(404, "a seat's page may ask for me, events, hand and hand-in");
    const json::object said = ObjectIn(request.body());
    const json::value* const up = said.if_contains("up");
    if (up == nullptr || !up->is_bool()) return ErrorAnswer(400, R"(write {"up": true}, or false)");
    room.RaiseHand(route.seat, up->as_bool());
    return JsonAnswer("{}");
  }

  HttpAnswer HandleProgram(const Guest& guest, const ClassRoute& route) {
    Program* const program = room.FindProgram(route.seat);
    if (program == nullptr) return ErrorAnswer(404, "there is no seat " + route.seat);
    const Request& request = guest.parser->get();
    const bool post = request.method() == http::verb::post;
    const bool teaches = route.kind == ClassRouteKind::kWallProgram;
    if (post && !teaches) room.NoteActive(route.seat, guest.peer.text);
    return AnswerProgram(*program, post, route.rest, request.body(), teaches);
  }

  HttpAnswer HandleTeacher(const Request& request, const std::string& what) {
    const bool post = request.method() == http::verb::post;
    if (post && what == "do") {
      const std::string error = room.Do(ObjectIn(request.body()));
      return error.empty() ? JsonAnswer("{}") : ErrorAnswer(400, error);
    }
    if (!post && what == "seats") return JsonAnswer(json::serialize(room.WallJson()));
    if (!post && what == "sheet") return HtmlAnswer(SheetPage(room.roll(), room.url()));
    if (!post && (what == "events" || what == "collect.tar")) return {.status = kLater};
    return ErrorAnswer(404, "the wall may ask for seats, events, sheet, do and collect.tar");
  }

  enum class Later { kEvents, kArchive, kHandIn };
  static Later LaterOf(const ClassRoute& route) {
    return route.rest == "events"    ? Later::kEvents
           : route.rest == "hand-in" ? Later::kHandIn
                                     : Later::kArchive;
  }

  asio::awaitable<std::string> HandIn(const ClassRoute& route) {
    struct Wait {
      explicit Wait(asio::io_context& context) : timer(context) {}
      std::optional<std::string> error;
      asio::steady_timer timer;
    };
    const auto wait = std::make_shared<Wait>(context);
    room.HandIn(route.seat, [wait](std::string error) {
      wait->error = std::move(error);
      wait->timer.cancel();
    });
    while (!wait->error) {
      wait->timer.expires_after(kRequestTime);
      co_await wait->timer.async_wait(kAwait);
    }
    co_return *wait->error;
  }

  /// All that the class keeps, as an archive; its length is not known before.
  asio::awaitable<void> Collect(GuestPtr guest) {
    std::array<int, 2> ends{-1, -1};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) co_return;
    asio::readable_pipe from(context, ends[0]);
    UniqueFd into(ends[1]);
    const UniqueFd nothing(::open("/dev/null", O_RDWR | O_CLOEXEC));
    std::ofstream(room.options().folder / kStudents) << room.roll().ToCsv(false);
    pid_t process = 0;
    const int error = Spawn("tar",
                            {"-C", room.options().folder.string(), "--exclude=door", "--exclude=*.new",
                             "--warning=none", "-cf", "-", kStudents, "seats"},
                            {nothing.get(), into.get(), nothing.get()}, process);
    into.Reset();
    if (error != 0) co_return;
    const std::string head = StreamHeader(
        "Content-Type: application/x-tar\r\nContent-Disposition: attachment; filename=\"class.tar\"");
    guest->stream.expires_after(kCollectTime);
    bool good = !std::get<0>(co_await asio::async_write(guest->stream, asio::buffer(head), kAwait));
    std::vector<char> block(std::size_t{64} << 10);
    while (good) {
      const auto [ended, count] = co_await from.async_read_some(asio::buffer(block), kAwait);
      if (ended) break;
      guest->stream.expires_after(kRequestTime);
      good =
          !std::get<0>(co_await asio::async_write(guest->stream, asio::buffer(block.data(), count), kAwait));
    }
    if (!good) ::kill(process, SIGKILL);
    error_code ignored;
    from.close(ignored);
    WaitFor(process);  // it has closed its end, or was killed
  }

  std::string EventOf(const ClassRoute& route) const {
    const bool student = route.kind == ClassRouteKind::kSeatAsks;
    return json::serialize(student ? room.StudentJson(route.seat) : room.WallJson());
  }

  /// Events for an EventSource: EventOf(), whenever it has changed.
  asio::awaitable<void> Stream(GuestPtr guest, const ClassRoute& route) {
    const std::string head = StreamHeader("Content-Type: text/event-stream");
    std::string out = head, told;
    std::uint64_t version = 0;
    asio::steady_timer pause(context);
    for (int quiet = 0;; ++quiet) {
      // What changes at one seat mostly leaves the others' events as they were.
      std::string now = version == room.version() ? told : EventOf(route);
      version = room.version();
      if (now != told || quiet >= kHeartbeat) {
        out += now == told ? ": still here\n\n" : "data: " + now + "\n\n";
        told = std::move(now);
        quiet = 0;
      }
      guest->stream.expires_after(kRequestTime);
      if (!out.empty() && std::get<0>(co_await asio::async_write(guest->stream, asio::buffer(out), kAwait)))
        co_return;
      guest->stream.expires_never();
      out.clear();
      pause.expires_after(kEventsEvery);
      if (std::get<0>(co_await pause.async_wait(kAwait)) || !waiting.contains(guest->ticket)) co_return;
    }
  }

  asio::awaitable<void> Answer(GuestPtr guest, const HttpAnswer& answer) {
    const Request& request = guest->parser->get();
    http::response<http::string_body> response(static_cast<http::status>(answer.status), 11);
    for (const auto& [name, value] : CommonHeaders()) response.set(name, value);
    for (const auto& [name, value] : answer.headers) response.insert(name, value);
    if (answer.status != 304) response.set(http::field::content_type, answer.type);
    response.keep_alive(false);
    response.body() = answer.body;
    response.prepare_payload();
    if (request.method() == http::verb::head) response.body().clear();
    guest->stream.expires_after(kRequestTime);
    co_await http::async_write(guest->stream, response, kAwait);
    // The client reads the answer before the connection breaks, though it may still send.
    error_code ignored;
    guest->stream.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
    guest->stream.expires_after(kDrainTime);
    std::vector<char> rest(std::size_t{16} << 10);
    for (std::size_t drained = 0; drained < kMaxBodyBytes;) {
      const auto [ended, count] = co_await guest->stream.async_read_some(asio::buffer(rest), kAwait);
      if (ended) co_return;
      drained += count;
    }
  }

  asio::io_context& context;
  ClassRoom& room;
  SeatGuard& guard;
  const TokenGuard teacher;
  const std::vector<std::string> host_names;
  const Clock& clock;
  Listener listener;
  Crowd guests{kMaxGuests, kMaxGuests};          // by network
  Crowd waiting{kMaxWaiting, kMaxWaitingOfOne};  // known ones who wait for an answer, by seat
};

ClassPages::ClassPages(asio::io_context& context, ClassRoom& room, SeatGuard& guard, std::string token,
                       std::vector<std::string> host_names, WrongTokens& wrong, const Clock& clock,
                       NetServices& services)
    : impl_(std::make_shared<Impl>(context, room, guard, std::move(token), std::move(host_names), wrong,
                                   clock, services)) {}

ClassPages::~ClassPages() {
  impl_->guests.Clear();
  impl_->waiting.Clear();
}

std::string ClassPages::Listen(const std::vector<std::string>& addresses, int port) {
  return impl_->listener.Listen(addresses, port);
}

int ClassPages::port() const {
  return impl_->listener.port();
}

}  // namespace coopdyn

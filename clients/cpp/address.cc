// SPDX-License-Identifier: MIT
#include "clients/cpp/address.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pwd.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <sstream>
#include <string_view>
#include <thread>

#include "clients/cpp/words.h"

namespace coopdyn::client {
namespace {

constexpr double kYear_s = 3.2e7;
constexpr std::size_t kMaxLine = 65536;  // of the name server
constexpr double kSeatStart_s = 20;      // of a seat's daemon: all start at once when a class begins
constexpr double kSeatAgain_s = 0.2;
constexpr std::string_view kUnix = "unix:";

std::string DefaultName() {
  const passwd* account = getpwuid(getuid());
  char host[256] = "";
  gethostname(host, sizeof(host) - 1);
  std::string name = std::string(account != nullptr ? account->pw_name : "user") + "@" + host + ":" +
                     std::to_string(getpid());
  std::erase_if(name, [](unsigned char c) { return c <= ' '; });
  return name;
}

int PortOf(const std::string& text) {
  if (text.empty() || text.size() > 5 || text.find_first_not_of("0123456789") != std::string::npos) return 0;
  const int port = std::stoi(text);
  return port < 65536 ? port : 0;
}

/// Connects. Returns 0 or an errno value.
int Connect(int fd, const addrinfo& to, Deadline deadline) {
  fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) | O_NONBLOCK);
  if (connect(fd, to.ai_addr, to.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  pollfd connecting{fd, POLLOUT, 0};
  if (poll(&connecting, 1, static_cast<int>(std::max(1.0, SecondsUntil(deadline) * 1000))) <= 0)
    return ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof(error);
  getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

/// Returns a connected, non-blocking socket; on failure an empty one, with errno set. `name`: a path, or a
/// zero byte and a name in the abstract namespace.
Socket ConnectUnix(const std::string& name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (name.size() >= sizeof(address.sun_path)) {
    errno = ENAMETOOLONG;
    return Socket();
  }
  std::memcpy(address.sun_path, name.data(), name.size());
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
  Socket socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const bool connected = connect(socket.fd(), reinterpret_cast<const sockaddr*>(&address), length) == 0;
  return connected ? std::move(socket) : Socket();
}

bool ConsistsOf(std::string_view text, std::string_view characters, std::size_t least, std::size_t most) {
  return text.size() >= least && text.size() <= most &&
         text.find_first_not_of(characters) == std::string_view::npos;
}

}  // namespace

Socket::~Socket() {
  if (fd_ >= 0) close(fd_);
}

Deadline After(double seconds, Deadline now) {
  return now + std::chrono::duration_cast<Clock::duration>(
                   std::chrono::duration<double>(std::clamp(seconds, 0.0, kYear_s)));
}

double SecondsUntil(Deadline deadline, Deadline now) {
  return std::chrono::duration<double>(deadline - now).count();
}

bool WaitReadable(const std::vector<int>& fds, double timeout_s) {
  std::vector<pollfd> polled;
  for (const int fd : fds) polled.push_back({fd, POLLIN, 0});
  return poll(polled.data(), polled.size(),
              static_cast<int>(std::ceil(std::clamp(timeout_s, 0.0, 3600.0) * 1000))) > 0;
}

bool WriteAll(int fd, const std::string& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = send(fd, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
    if (n >= 0) {
      done += static_cast<std::size_t>(n);
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      pollfd writable{fd, POLLOUT, 0};
      if (poll(&writable, 1, 10000) <= 0) return false;
    } else if (errno != EINTR) {
      return false;
    }
  }
  return true;
}

Address::Address(const std::string& server, const std::string& name, const std::string& token,
                 double timeout_s, const std::optional<std::string>& seat, const std::string& pin)
    : name_(name.empty() ? DefaultName() : name), token_(token), timeout_s_(timeout_s) {
  TakeServer(server);
  TakeSeat(seat, pin);
  if (std::any_of(name_.begin(), name_.end(), [](unsigned char c) { return c <= ' '; }))
    throw Error(3, "a client name has no spaces, not '" + name_ + "'; write e.g. \"ana\"");
}

void Address::TakeServer(const std::string& server) {
  std::string given = server;
  if (const char* variable = std::getenv("COOPDYN_SERVER"); given.empty() && variable != nullptr)
    given = variable;
  if (given.empty()) given = "127.0.0.1";
  if (given.starts_with(std::string(kUnix) + "/")) {
    host_ = given;
    port_ = 0;
    return;
  }
  if (given.find("://") != std::string::npos)
    throw Error(4, given +
                       " is the address of the page; a program connects to the name server, whose HOST:PORT "
                       "`coopdyn serve` prints: write e.g. connect(\"127.0.0.1:10000\")");
  host_ = given;
  if (const std::size_t close = given.find(']'); given[0] == '[' && close != std::string::npos) {
    host_ = given.substr(1, close - 1);
    if (close + 1 < given.size()) port_ = given[close + 1] == ':' ? PortOf(given.substr(close + 2)) : 0;
  } else if (given.find_first_not_of("0123456789") == std::string::npos) {  // a port of this machine
    host_ = "127.0.0.1";
    port_ = PortOf(given);
  } else if (std::count(given.begin(), given.end(), ':') == 1) {
    host_ = given.substr(0, given.find(':'));
    port_ = PortOf(given.substr(given.find(':') + 1));
  }
  if (host_.empty() || port_ == 0)
    throw Error(
        4, "cannot read the server '" + given +
               "'; write HOST, HOST:PORT, or a port of this machine, e.g. \"labserver:10100\"; for a unix "
               "socket unix:/PATH");
}

void Address::TakeSeat(const std::optional<std::string>& seat, const std::string& pin) {
  seat_ = seat.value_or("");
  pin_ = pin;
  if (const char* variable = std::getenv("COOPDYN_SEAT"); !seat && pin.empty() && variable != nullptr) {
    std::istringstream given(variable);
    std::getline(given, seat_, ':');
    std::getline(given, pin_);
  }
  if (seat_.empty() && pin_.empty()) return;
  const std::string how =
      "; write connect(\"labserver\", {.seat = \"ana\", .pin = \"7305\"}) as on your sheet, or "
      "COOPDYN_SEAT=ana:7305";
  if (pin_.empty()) throw Error(3, "the seat " + seat_ + " needs its PIN" + how);
  if (seat_.empty()) throw Error(3, "a PIN needs its seat" + how);
  constexpr std::string_view kLower = "abcdefghijklmnopqrstuvwxyz0123456789_-";
  if (!ConsistsOf(seat_, kLower, 1, 32) || seat_[0] == '_' || seat_[0] == '-')
    throw Error(3, "the name of a seat has only a-z, 0-9, - and _, not '" + seat_ + "'" + how);
  if (!ConsistsOf(pin_, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789", 4, 16))
    throw Error(3, "a PIN has 4 to 16 letters or digits, not '" + pin_ + "'" + how);
}

std::string Address::text() const {
  if (port_ == 0) return host_;
  return (host_.find(':') != std::string::npos ? "[" + host_ + "]" : host_) + ":" + std::to_string(port_);
}

std::string Address::HelloText(bool drives, int number) const {
  return name_ + (drives ? "" : ":reader") + (number > 1 ? ":" + std::to_string(number) : "") +
         (token_.empty() ? "" : " " + token_);
}

std::string Address::Authorization() const {
  return seat_.empty() ? "" : "Bearer " + seat_ + ":" + pin_;
}

std::string Address::LossHint() const {
  if (seat_.empty()) return "is the daemon still running?";
  return "the class restarts the seat " + seat_ + " where it was: run your program again";
}

Socket Address::Dial(Deadline deadline) const {
  Socket local = DialLocal();
  return local.fd() >= 0 ? std::move(local) : DialPort(deadline);
}

Socket Address::DialPort(Deadline deadline) const {
  return port_ == 0 ? DialUnix() : DialTcp(deadline);
}

Socket Address::DialUnix() const {
  Socket socket = ConnectUnix(host_.substr(kUnix.size()));
  if (socket.fd() >= 0) return socket;
  const std::string why = std::strerror(errno);
  throw Error(Error::kNoConnection,
              "nothing can be reached at " + host_ + ": " + why + "; a daemon's port is HOST:PORT");
}

/// An exchange over the unix socket costs half as much as over TCP.
Socket Address::DialLocal() const {
#ifdef __linux__
  const char* const forced = std::getenv("COOPDYN_TCP");
  const bool by_tcp = forced != nullptr && *forced != '\0' && std::strcmp(forced, "0") != 0;
  const bool here = host_ == "127.0.0.1" || host_ == "localhost" || host_ == "::1";
  if (!here || by_tcp || !seat_.empty()) return Socket();
  Socket socket = ConnectUnix(std::string(1, '\0') + "coopdyn-" + std::to_string(port_));
  if (socket.fd() < 0) return Socket();
  // Any user of this machine can bind the name while no daemon has it: the listener must belong to this user
  // or root.
  ucred who{};
  socklen_t size = sizeof(who);
  if (getsockopt(socket.fd(), SOL_SOCKET, SO_PEERCRED, &who, &size) == 0 &&
      (who.uid == geteuid() || who.uid == 0))
    return socket;
#endif
  return Socket();
}

Socket Address::DialTcp(Deadline deadline) const {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(host_.c_str(), std::to_string(port_).c_str(), &hints, &found) != 0)
    throw Error(Error::kNoConnection,
                "no machine is called '" + host_ + "'; check the name, or write its address");
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(found, freeaddrinfo);
  int error = ECONNREFUSED;
  for (const addrinfo* a = found; a != nullptr; a = a->ai_next) {
    Socket socket(::socket(a->ai_family, a->ai_socktype | SOCK_CLOEXEC, a->ai_protocol));
    if (socket.fd() < 0) continue;
    error = Connect(socket.fd(), *a, deadline);
    if (error != 0) continue;
    const int on = 1;
    setsockopt(socket.fd(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    return socket;
  }
  if (error == ETIMEDOUT)
    throw Error(kTimedOut,
                "no answer from " + text() + " within " + Written(timeout_s_) +
                    " s: the machine is off, the address is wrong, or a firewall drops the packets; try "
                    "`ping`, or a tunnel: ssh -L 10000:127.0.0.1:10000 HOST");
  if (error == ECONNREFUSED)
    throw Error(Error::kNoConnection,
                "nothing listens at " + text() +
                    ": start the daemon there (coopdyn serve; for other machines add --host 0.0.0.0), or "
                    "name the server: connect(\"HOST:PORT\") or COOPDYN_SERVER");
  throw Error(Error::kNoConnection, "cannot reach " + text() + ": " + std::strerror(error));
}

std::string Address::ReadLine(const Socket& socket, Deadline deadline) const {
  std::string line;
  while (!line.ends_with('\n') && line.size() < kMaxLine) {
    if (SecondsUntil(deadline) <= 0)
      throw Error(kTimedOut,
                  text() +
                      " accepts connections but does not answer: the daemon is stopped or busy, or "
                      "something else listens there; try `coopdyn status`");
    char byte = 0;
    const ssize_t n = recv(socket.fd(), &byte, 1, 0);
    if (n == 1) {
      line += byte;
    } else if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) {
      WaitReadable({socket.fd()}, SecondsUntil(deadline));
    } else {
      break;
    }
  }
  line.erase(line.find_last_not_of("\r\n") + 1);
  return line;
}

Error Address::NotADaemon(const std::string& said) const {
  const std::string heard =
      said.empty() ? "it closed the connection without an answer" : "it said '" + said.substr(0, 60) + "'";
  return Error(Error::kNoConnection,
               "what listens at " + text() + " is not a coopdyn daemon (" + heard +
                   "); name the server's port, which `coopdyn serve` prints: HOST:PORT");
}

Error Address::Refusal(const std::string& said) const {
  // error 10 no such name /robot9/motors; did you mean /robot1/motors
  std::istringstream words(said);
  std::string word, why;
  int code = 0;
  if (words >> word >> code >> std::ws && word == "error" && std::getline(words, why))
    return Error(code, why);
  if (seat_.empty() || !said.empty()) return NotADaemon(said);
  return Error(Error::kNoConnection, text() + " closed the connection of the seat " + seat_ +
                                         " without an answer; ask your teacher whether the class runs there, "
                                         "and this seat");
}

Deadline Address::Begin(const Socket& socket, const std::string& line, Deadline deadline) const {
  WriteAll(socket.fd(), (seat_.empty() ? "" : "SEAT " + seat_ + " " + pin_ + " cpp\n") + line + "\n");
  if (seat_.empty()) return deadline;
  const std::string said = ReadLine(socket, deadline);
  if (said.starts_with("***"))  // a name server's answer to an unknown word
    throw Error(kNotPossible, text() + " is not a class: leave seat and pin out" +
                                  (std::getenv("COOPDYN_SEAT") != nullptr ? ", and COOPDYN_SEAT, too" : ""));
  if (said != "ok") throw Refusal(said);
  return std::max(deadline, After(kSeatStart_s));
}

std::vector<Module> Address::Modules() const {
  Deadline deadline = After(timeout_s_);
  const Socket socket = Dial(deadline);
  deadline = Begin(socket, "NAME_SERVER list", deadline);
  std::vector<Module> modules;
  while (true) {
    const std::string line = ReadLine(socket, deadline);
    if (line.starts_with("***")) break;
    std::istringstream words(line);  // registration name /robot1/motors ip 127.0.0.1 port 10002 type tcp
    std::string registration, word;
    Module module;
    words >> registration >> word >> module.name >> word >> module.host >> word >> module.port;
    if (registration != "registration") throw Refusal(line);
    if (module.name.starts_with("/")) modules.push_back(module);
  }
  if (modules.empty()) throw NotADaemon("a list without modules");
  return modules;
}

Socket Address::OpenModule(const std::string& module, Deadline deadline) const {
  while (true) {
    Socket socket = Dial(deadline);
    const std::string said = ReadLine(socket, Begin(socket, "OPEN " + module, deadline));
    if (said == "ok") return socket;
    const bool starts_again = !seat_.empty() && said.empty() && SecondsUntil(deadline) > kSeatAgain_s;
    if (!starts_again) throw Refusal(said);
    std::this_thread::sleep_for(std::chrono::duration<double>(kSeatAgain_s));
  }
}

}  // namespace coopdyn::client

// SPDX-License-Identifier: MIT
#include "server/app/remote_connection.h"

#include <netdb.h>

#include <charconv>
#include <istream>

#include "protocol/codec.h"
#include "server/app/commands.h"

namespace coopdyn {

namespace {

constexpr std::chrono::seconds kConnectTime{3};
constexpr std::chrono::seconds kAnswerTime{10};  // for the name server, which answers at once
constexpr std::chrono::seconds kSeatTime{30};    // for the daemon of a seat, which may have to start
constexpr std::size_t kMostShown = 200;          // characters of an unexpected line
constexpr std::size_t kOfEachLine = 32;          // overhead per stored line, bytes

}  // namespace

std::shared_ptr<ServerOptions> AddServerOptions(CLI::App& command) {
  auto options = std::make_shared<ServerOptions>();
  command
      .add_option("--server", options->server,
                  "HOST[:PORT] of the daemon (default: this machine, port 10000)")
      ->envname("COOPDYN_SERVER");
  command.add_option("--token", options->token, "The daemon's token, from another machine")
      ->envname("COOPDYN_TOKEN");
  command.add_option("--seat", options->seat, "NAME:PIN of a seat in a class (coopdyn host), e.g. ana:7305")
      ->envname("COOPDYN_SEAT");
  return options;
}

ServerAddress::ServerAddress(const std::string& text, const std::string& seat) {
  if (!seat.empty()) {
    const std::size_t middle = seat.find(':');
    const bool pair = middle != std::string::npos && middle == seat.rfind(':') && middle > 0 &&
                      middle + 1 < seat.size() && seat.find_first_of(" \t\r\n") == std::string::npos;
    if (!pair)
      throw RemoteError(kExitWrongUse, "--seat is NAME:PIN as on your sheet, e.g. ana:7305, not " + seat);
    seat_line = "SEAT " + seat.substr(0, middle) + " " + seat.substr(middle + 1);
  }
  const RemoteError wrong(kExitWrongUse, "--server is HOST or HOST:PORT, e.g. labserver:10000, not " + text);
  const bool digits = text.find_first_not_of("0123456789") == std::string::npos;
  const std::size_t end = text.starts_with('[') ? text.find(']') : 0;
  if (end == std::string::npos) throw wrong;
  const std::size_t colon = text.find(':', end);
  // "::1" without brackets has no port.
  const bool has_port =
      colon != std::string::npos && (end > 0 || text.find(':', colon + 1) == std::string::npos);
  std::string name = has_port ? text.substr(0, colon) : digits ? "" : text;
  if (end > 0) {
    if (name.size() != end + 1) throw wrong;
    name = name.substr(1, end - 1);
  }
  if (!name.empty()) host = name;
  const std::string number = has_port ? text.substr(colon + 1) : digits ? text : "";
  if (number.empty() && !has_port) return;
  const auto [last, error] = std::from_chars(number.data(), number.data() + number.size(), port);
  if (error != std::errc() || last != number.data() + number.size() || port < 1 || port > 65535) throw wrong;
}

RemoteConnection::RemoteConnection(const ServerAddress& server) {
  namespace asio = boost::asio;
  const std::string port = std::to_string(server.port);
  stream_.expires_after(kConnectTime);
  stream_.connect(server.host, port);
  if (const auto error = stream_.error(); error.category() == asio::error::get_netdb_category()) {
    const std::string why =
        error == asio::error::host_not_found ? ::gai_strerror(EAI_NONAME) : error.message();
    throw RemoteError(kExitNoDaemon, "there is no host " + server.host + " (" + why + "): check its name");
  } else if (error) {
    throw RemoteError(kExitNoDaemon,
                      "no daemon answers at " + server.host + ":" + port + " (" + error.message() +
                          "): start one with coopdyn serve, or say where it is with --server HOST:PORT");
  }
  stream_.expires_after(kAnswerTime);
  stream_.socket().set_option(asio::ip::tcp::no_delay(true));
  if (!server.seat_line.empty()) TakeSeat(server);
}

void RemoteConnection::TakeSeat(const ServerAddress& server) {
  Send(server.seat_line + "\n");
  const std::string reply = ReadLine();
  if (reply.starts_with("***"))  // a name server's answer to a word that it does not know
    throw RemoteError(kExitErrors, server.host + ":" + std::to_string(server.port) +
                                       " is not a class: leave --seat and COOPDYN_SEAT out");
  if (reply != "ok") throw RemoteError(kExitErrors, reply.substr(0, kMostShown));
  stream_.expires_after(kSeatTime);
}

void RemoteConnection::Send(const std::string& bytes) {
  if (stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush()) return;
  throw RemoteError(kExitErrors, "the daemon closed the connection (" + stream_.error().message() + ")");
}

std::string RemoteConnection::ReadLine() {
  std::string line;
  for (int c = stream_.get(); c != '\n'; c = stream_.get()) {
    if (c == std::char_traits<char>::eof()) throw NoAnswer();
    if (line.size() > kMaxReplyBytes) throw Unreadable();
    line += static_cast<char>(c);
  }
  if (line.ends_with('\r')) line.pop_back();
  return line;
}

RemoteError RemoteConnection::NoAnswer() const {
  if (stream_.error() != boost::asio::error::timed_out)
    return {kExitErrors, "the daemon closed the connection"};
  return {kExitNoDaemon,
          "a program accepts connections there but does not answer: a starting daemon answers when it is "
          "ready; any other program is not coopdyn"};
}

RemoteError RemoteConnection::Unreadable() {
  return {kExitErrors, "the daemon answered something unreadable"};
}

std::vector<std::string> RemoteConnection::AskNames(const std::string& line) {
  Send("NAME_SERVER " + line + "\n");
  std::vector<std::string> answer;
  std::size_t bytes = 0;
  for (std::string reply = ReadLine(); !reply.starts_with("*** end of message"); reply = ReadLine()) {
    if (reply.starts_with("error "))
      throw RemoteError(kExitErrors, reply.substr(0, kMostShown));  // of a class
    if (bytes += reply.size() + kOfEachLine; bytes > kMaxReplyBytes) throw Unreadable();
    answer.push_back(std::move(reply));
  }
  return answer;
}

void RemoteConnection::Open(const std::string& name) {
  Send("OPEN " + name + "\n");
  if (const std::string reply = ReadLine(); reply != "ok")
    throw RemoteError(kExitErrors, reply.substr(0, kMostShown));
  stream_.expires_at(boost::asio::ip::tcp::iostream::time_point::max());  // a reply may wait for a step
}

Message RemoteConnection::Call(const Message& request) {
  std::string bytes;
  if (!binary_started_) bytes = kBinaryMagic;
  binary_started_ = true;
  EncodeBinary(request, bytes);
  Send(bytes);
  for (std::string received;;) {
    Decoded decoded = DecodeBinary(received, kMaxReplyBytes);
    if (decoded.status == DecodeStatus::kNeedMore) {
      if (stream_.peek() == std::char_traits<char>::eof()) {
        throw RemoteError(kExitErrors, "the daemon closed the connection");
      }
      const std::size_t have = received.size();
      received.resize(have + static_cast<std::size_t>(stream_.rdbuf()->in_avail()));
      stream_.read(received.data() + have, static_cast<std::streamsize>(received.size() - have));
      continue;
    }
    if (decoded.status != DecodeStatus::kMessage) {
      throw Unreadable();
    }
    received.erase(0, decoded.consumed);
    if (decoded.message.command == -1) throw RemoteError(kExitErrors, decoded.message.text);  // it closes
    const bool pushed = decoded.message.command != request.command && decoded.message.error == 0;
    if (!pushed) return std::move(decoded.message);
  }
}

std::string RemoteConnection::CallLine(const std::string& line) {
  Send(line + "\n");
  std::string reply;
  do {
    reply = ReadLine();
  } while (reply.empty() || reply.front() == '#');
  return reply;
}

std::string RemoteConnection::AskComments(const std::string& line) {
  Send(line + "\nping\n");  // the reply to ping marks the end of the comments
  std::string comments, reply = ReadLine();
  for (; reply.starts_with('#'); reply = ReadLine()) comments += reply + "\n";
  if (!reply.starts_with("0 ")) throw RemoteError(kExitErrors, reply);
  return comments;
}

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
#include "web_fixture.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <utility>

#include "protocol/command_ids.h"
#include "protocol/module_tables.h"

namespace coopdyn {

namespace {

Message Reply(const Message& request) {
  return {.error = 0, .text = {}, .command = request.command, .params = {}, .data = {0.5, 50}};
}

}  // namespace

FakeMotors::FakeMotors() : table_(MotorsTable()) {}

void FakeMotors::OnRequest(Connection& connection, Message request, ReplyFunction reply) {
  Message answer = Reply(request);
  peer = connection.peer();
  trusted = connection.trusted();
  switch (request.command) {
    case command::kPing:
      answer.params = request.params;
      answer.data = request.data;
      return reply(answer);
    case command::kGetWheels:
      answer.data = {std::numeric_limits<double>::infinity(), -0.25, 0.5, 50};
      return reply(answer);
    case command::kSubscribe: {
      reply(answer);
      answer.command = -command::kGetWheels;
      connection.Push(UnaskedPtr(new UnaskedMessage(std::move(answer))), 0);
      return;
    }
    case command::kStop:
      waiting_replies_.push_back([reply, answer](const Message&) { reply(answer); });
      ++waiting;
      return;
    case command::kSetVelocity:
      if (owner_ != 0 && owner_ != connection.id()) {
        return reply(ErrorReply(request.command, Error::kOwned, "owned by " + owner_peer_));
      }
      if (owner_ == 0) ++open_owners;
      owner_ = connection.id();
      owner_peer_ = connection.peer();
      answer.params = {0};
      return reply(answer);
    default:
      return reply(ErrorReply(request.command, Error::kUnknownCommand, "unknown"));
  }
}

void FakeMotors::OnClosed(Connection& connection) {
  if (connection.id() == owner_) {
    owner_ = 0;
    --open_owners;
  }
  ++closed;
}

void FakeMotors::Release() {
  for (const ReplyFunction& reply : std::exchange(waiting_replies_, {})) reply({});
}

FakeSimulation::FakeSimulation() : table_(SimulationTable()) {}

void FakeSimulation::OnRequest(Connection& connection, Message request, ReplyFunction reply) {
  Message answer = Reply(request);
  if (request.command == command::kGetStatus) {
    answer.text = R"({"mode":"realtime","step":)" + std::to_string(++asked) + "}";
  } else if (!connection.trusted()) {
    answer = ErrorReply(request.command, Error::kNotAllowed, "needs the token");
  }
  reply(answer);
}

FakePainter::FakePainter(ImageBoard& board)
    : board_(board), thread_([this](std::stop_token stop) {
        while (!stop.stop_requested()) {
          for (const ImageBoard::Pending& pending : board_.WaitAndTake(stop, clock_, 0)) {
            const std::string text = "picture " + std::to_string(++drawn);
            ImageResult result;
            result.bytes = std::make_shared<std::vector<std::uint8_t>>(text.begin(), text.end());
            result.camera.eye_m = pending.request.eye_m.value_or(Vector3(-3, 0, 2));
            pending.done(result);
          }
        }
      }) {}

WebOptions WebWorld::DefaultOptions() {
  static const TokenGuard guard("secret", true);
  WebOptions options;
  options.host_names = {"labserver"};
  options.guard = &guard;
  options.version = "1.2.3";
  options.name_port = 10000;
  options.names = [](const std::string&) { return std::vector<std::string>{"classroom", "corridor"}; };
  return options;
}

WebWorld::WebWorld(WebOptions options) {
  motors_server = std::make_unique<ModuleServer>(modules, motors, services, "/robot1/motors");
  simulation_server = std::make_unique<ModuleServer>(modules, simulation, services, "/simulation");
  names.AddOwn("/robot1/motors", 10002, motors_server->adopter());
  names.AddOwn("/simulation", 10006, simulation_server->adopter());
  names.Register("/elsewhere", "tcp", "10.0.0.9", 4711, {"10.0.0.9"});
  PublishFrame(1);
  web = std::make_unique<WebServer>(std::move(options), names, frames, &images, services);
  EXPECT_EQ(web->Listen({"127.0.0.1"}, 0), "");
  port = web->port();
}

WebWorld::~WebWorld() {
  web->Stop();
  modules.Stop();
}

void WebWorld::PublishFrame(std::uint64_t step) {
  auto frame = std::make_shared<Frame>();
  frame->step = step;
  frames.Publish(std::move(frame));
}

RawClient::RawClient(int port) : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const timeval patience{60, 0};
  ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  if (::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ADD_FAILURE() << "cannot connect to port " << port;
  }
}

RawClient::~RawClient() {
  ::close(fd_);
}

void RawClient::Send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count <= 0) return;  // the peer has closed: its bytes can still be read
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

void RawClient::EndInput() {
  ::shutdown(fd_, SHUT_WR);
}

bool RawClient::HasEnded(std::chrono::milliseconds patience) {
  pollfd wait{fd_, POLLRDHUP, 0};
  return ::poll(&wait, 1, static_cast<int>(patience.count())) > 0;
}

std::string RawClient::ReadAll() {
  std::array<char, 4096> chunk;
  for (ssize_t count = 1; count > 0;) {
    count = ::recv(fd_, chunk.data(), chunk.size(), 0);
    if (count > 0) buffer_.append(chunk.data(), static_cast<std::size_t>(count));
    if (count < 0 && errno == EAGAIN) ADD_FAILURE() << "the peer did not close";
  }
  return std::exchange(buffer_, {});
}

std::string RawClient::ReadUntil(std::string_view end) {
  std::array<char, 4096> chunk;
  while (buffer_.find(end) == std::string::npos) {
    const ssize_t count = ::recv(fd_, chunk.data(), chunk.size(), 0);
    if (count <= 0) {
      ADD_FAILURE() << "the end came before " << end << ", after: " << buffer_;
      return std::exchange(buffer_, {});
    }
    buffer_.append(chunk.data(), static_cast<std::size_t>(count));
  }
  const std::size_t size = buffer_.find(end) + end.size();
  const std::string read = buffer_.substr(0, size);
  buffer_.erase(0, size);
  return read;
}

std::string RawClient::ReadBytes(std::size_t count) {
  std::array<char, 4096> chunk;
  while (buffer_.size() < count) {
    const ssize_t got = ::recv(fd_, chunk.data(), chunk.size(), 0);
    if (got <= 0) break;
    buffer_.append(chunk.data(), static_cast<std::size_t>(got));
  }
  const std::string read = buffer_.substr(0, count);
  buffer_.erase(0, read.size());
  return read;
}

HttpReply Fetch(int port, std::string_view method, std::string_view target, std::string_view body,
                std::string_view headers) {
  RawClient client(port);
  std::string request =
      std::string(method) + " " + std::string(target) + " HTTP/1.1\r\nConnection: close\r\n";
  if (headers.find("Host:") == std::string_view::npos)
    request += "Host: 127.0.0.1:" + std::to_string(port) + "\r\n";
  request += headers;
  if (!body.empty()) {
    if (headers.find("Content-Type:") == std::string_view::npos)
      request += "Content-Type: application/json\r\n";
    request += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  }
  client.Send(request + "\r\n" + std::string(body));
  const std::string text = client.ReadAll();
  HttpReply reply;
  const auto end = text.find("\r\n\r\n");
  if (text.size() < 12 || end == std::string::npos) {
    ADD_FAILURE() << "not an HTTP reply: " << text;
    return reply;
  }
  reply.status = std::atoi(text.substr(9, 3).c_str());
  reply.header = text.substr(0, end + 2);
  reply.body = text.substr(end + 4);
  return reply;
}

}  // namespace coopdyn

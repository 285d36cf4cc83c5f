// SPDX-License-Identifier: MIT
#include "echo_server.h"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "bench_scene.h"
#include "protocol/codec.h"
#include "server/physics/world.h"
#include "server/sensing/readings.h"

namespace coopdyn {

bool ReceiveExactly(int fd, char* bytes, std::size_t size, int spin_us) {
  std::size_t have = 0;
  if (spin_us > 0) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::microseconds(spin_us);
    do {
      const ssize_t now = ::recv(fd, bytes + have, size - have, MSG_DONTWAIT);
      if (now == 0) return false;
      if (now > 0) have += static_cast<std::size_t>(now);
    } while (have < size && std::chrono::steady_clock::now() < until);
  }
  while (have < size) {
    const ssize_t now = ::recv(fd, bytes + have, size - have, 0);
    if (now <= 0) return false;
    have += static_cast<std::size_t>(now);
  }
  return true;
}

int ConnectTo(int port) {
  const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    std::perror("connect");
    std::exit(1);
  }
  const int on = 1;
  ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return fd;
}

void SendAll(int fd, const std::string& bytes) {
  if (::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size())) return;
  std::perror("send");
  std::exit(1);
}

namespace {

void ServeOne(int listener, int spin_us) {
  const int fd = ::accept(listener, nullptr, nullptr);
  const int on = 1;
  ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  const auto scene = MakeScene(BenchScenario(1));
  Diagnostics diagnostics;
  const auto world = PhysicsWorld::Build(scene, 1, diagnostics);
  std::uint64_t step = 0;
  std::array<char, 64> head;
  std::string body, out;
  while (ReceiveExactly(fd, head.data(), 4, spin_us)) {
    std::uint32_t size;
    std::memcpy(&size, head.data(), 4);
    body.assign(head.data(), 4);
    body.resize(4 + size);
    if (!ReceiveExactly(fd, body.data() + 4, size, 0)) break;
    const Message request = DecodeBinary(body).message;
    const std::array<Setpoint, 2> setpoints{{{request.data[0]}, {request.data[1]}}};
    world->Step(kDefaultStep, 1, setpoints);
    const auto frame = std::make_shared<Frame>();
    frame->scene = scene;
    frame->step = ++step;
    world->Fill(*frame);
    Message reply;
    reply.command = request.command;
    const std::span<const double> distances = Distances(*frame, 0);
    reply.data.assign(distances.begin(), distances.end());
    for (const Sighting& seen : SeenTargets(*frame, 0)) {
      reply.data.push_back(seen.distance_m);
      reply.data.push_back(seen.bearing_rad);
    }
    reply.params = {1, static_cast<std::int32_t>(distances.size()), 2};
    reply.data.push_back(1e-2 * static_cast<double>(step));
    reply.data.push_back(static_cast<double>(step));
    out.clear();
    EncodeBinary(reply, out);
    if (::send(fd, out.data(), out.size(), MSG_NOSIGNAL) < 0) break;
  }
  ::close(fd);
}

}  // namespace

EchoServer::EchoServer(int spin_us) {
  listener_ = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address);
  ::listen(listener_, 1);
  ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this, spin_us] { ServeOne(listener_, spin_us); });
}

EchoServer::~EchoServer() {
  thread_.join();
  ::close(listener_);
}

}  // namespace coopdyn

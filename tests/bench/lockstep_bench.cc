// SPDX-License-Identifier: MIT
// Lockstep rounds per second over sockets. In a round every robot receives its command and answers with all
// distances and its target. Compared with an echo server that computes the same step inline, alternately
// within one run.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "bench_scene.h"
#include "clients/cpp/coopdyn_client.h"
#include "echo_server.h"
#include "protocol/codec.h"
#include "protocol/command_ids.h"
#include "tests/bench/bench_daemon.h"
#include "tests/bench/measures.h"

namespace coopdyn {
namespace {

struct Options {
  int rounds = 5000;
  int repeats = 5;
};

std::string CommandBytes() {
  Message command;
  command.command = command::kSetWheelSpeeds;
  command.data = {3.0, 3.5};
  std::string bytes;
  EncodeBinary(command, bytes);
  return bytes;
}

/// Reads one reply; returns its total size.
std::size_t ReadReply(int fd, std::vector<char>& buffer, int spin_us) {
  buffer.resize(4);
  if (!ReceiveExactly(fd, buffer.data(), 4, spin_us)) std::exit(1);
  std::uint32_t size;
  std::memcpy(&size, buffer.data(), 4);
  buffer.resize(4 + size);
  if (!ReceiveExactly(fd, buffer.data() + 4, size, 0)) std::exit(1);
  return buffer.size();
}

/// Rounds per second: writes all commands, then reads all replies, each in one read of its known size.
double Rounds(const std::vector<int>& robots, int rounds, int spin_us) {
  const std::string command = CommandBytes();
  std::vector<char> buffer;
  SendAll(robots[0], command);
  for (std::size_t i = 1; i < robots.size(); ++i) SendAll(robots[i], command);
  std::size_t size = 0;
  for (const int fd : robots) size = ReadReply(fd, buffer, spin_us);
  buffer.resize(size);
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < rounds; ++k) {
    for (const int fd : robots) SendAll(fd, command);
    for (const int fd : robots) {
      if (!ReceiveExactly(fd, buffer.data(), size, spin_us)) std::exit(1);
    }
  }
  return rounds / std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void Attach(int fd) {
  Message attach;
  attach.command = command::kAttach;
  attach.text = "distance target";
  std::string bytes;
  EncodeBinary(attach, bytes);
  SendAll(fd, bytes);
  std::vector<char> buffer;
  ReadReply(fd, buffer, 0);
}

BenchDaemonOptions DaemonOf(int robots, int spin_us) {
  return {.files = {{"bench.scenario", BenchScenarioText(robots)}},
          .words = {"--spin", std::to_string(spin_us)},
          .program = COOPDYN_BINARY};
}

/// A connection to a module, in the binary encoding.
int Open(const BenchDaemon& daemon, const std::string& module) {
  const int fd = ConnectTo(std::stoi(daemon.address().substr(daemon.address().find(':') + 1)));
  SendAll(fd, "OPEN " + module + "\n");
  char answer[3];
  if (!ReceiveExactly(fd, answer, sizeof answer, 0)) std::exit(1);
  SendAll(fd, std::string(kBinaryMagic));
  return fd;
}

double DaemonRounds(int robots, int rounds, int spin_us) {
  const BenchDaemon daemon(DaemonOf(robots, spin_us));
  std::vector<int> fds;
  for (int i = 1; i <= robots; ++i) {
    fds.push_back(Open(daemon, "/robot" + std::to_string(i) + "/motors"));
    Attach(fds.back());
  }
  const double rate = Rounds(fds, rounds, spin_us);
  for (const int fd : fds) ::close(fd);
  return rate;
}

double EchoRounds(int rounds, int spin_us) {
  const EchoServer server(spin_us);
  const int fd = ConnectTo(server.port());
  const double rate = Rounds({fd}, rounds, spin_us);
  ::close(fd);
  return rate;
}

double ClientRounds(int rounds, int spin_us) {
  const BenchDaemon daemon(DaemonOf(1, spin_us));
  ::setenv("COOPDYN_SPIN", std::to_string(spin_us).c_str(), 1);
  auto sim = client::connect(daemon.address());
  auto robot = sim.robot("robot1");
  robot.sense("red");
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < rounds; ++k) {
    robot.set_wheel_speeds(3.0, 3.5);
    sim.step();
    robot.sense("red");
  }
  const double rate =
      rounds / std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  sim.close();
  return rate;
}

void Compare(const Options& options, int spin_us) {
  std::vector<double> echo, daemon, client;
  for (int i = 0; i < options.repeats; ++i) {
    echo.push_back(EchoRounds(options.rounds, spin_us));
    daemon.push_back(DaemonRounds(1, options.rounds, spin_us));
    client.push_back(ClientRounds(options.rounds, spin_us));
  }
  std::printf(
      "1 robot, spin %2d us: echo %7.0f, daemon %7.0f (%.2f of echo), C++ client %7.0f (%.2f of echo) "
      "steps/s\n",
      spin_us, Median(echo), Median(daemon), Median(daemon) / Median(echo), Median(client),
      Median(client) / Median(echo));
}

void Many(const Options& options, int robots) {
  std::vector<double> rates;
  const int rounds = std::max(20, options.rounds / robots);
  for (int i = 0; i < options.repeats; ++i) rates.push_back(DaemonRounds(robots, rounds, 0));
  std::printf("%d robots, one connection each: %.0f rounds/s\n", robots, Median(rates));
}

int Main(int argc, char** argv) {
  Options options;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--rounds") == 0) options.rounds = std::atoi(argv[i + 1]);
    if (std::strcmp(argv[i], "--repeats") == 0) options.repeats = std::atoi(argv[i + 1]);
  }
  Compare(options, 50);
  Compare(options, 0);
  Many(options, 10);
  Many(options, 100);
  return 0;
}

}  // namespace
}  // namespace coopdyn

int main(int argc, char** argv) {
  return coopdyn::Main(argc, argv);
}

// SPDX-License-Identifier: MIT
// coopdyn doctor: walks from the host's name to a robot that answers; `ok`, or cause and cure, per line.
#include <algorithm>
#include <string_view>
#include <vector>

#include "protocol/command_ids.h"
#include "server/app/commands.h"
#include "server/app/print.h"
#include "server/app/remote_connection.h"
#include "server/base/clock.h"

namespace coopdyn {

namespace {

constexpr int kPings = 50;

/// Prints one line of the walk; true if it went well.
bool Say(const std::string& what, const std::string& error) {
  Print("{:<8} {}{}{}\n", error.empty() ? "ok" : "FAILED", what, error.empty() ? "" : ": ", error);
  return error.empty();
}

/// The median round trip of a ping, in microseconds; negative if one failed.
double MedianRoundTrip(RemoteConnection& connection) {
  const SteadyClock clock;
  std::vector<Nanoseconds> times;
  Message ping, reply;
  ping.command = command::kPing;
  for (int i = 0; i < kPings; ++i) {
    const Nanoseconds before = clock.Now();
    if (!connection.Call(ping, reply).empty() || reply.error != 0) return -1;
    times.push_back(clock.Now() - before);
  }
  std::nth_element(times.begin(), times.begin() + kPings / 2, times.end());
  return static_cast<double>(times[kPings / 2]) * 1e-3;
}

/// Asks the first robot of the list where it is.
int VisitRobot(const ServerAddress& server, const std::vector<std::string>& registrations) {
  constexpr std::string_view kBefore = "registration name ", kModule = "/pose ";
  for (const std::string& registration : registrations) {
    const std::size_t end = registration.find(kModule);
    if (!registration.starts_with(kBefore) || end == std::string::npos) continue;
    const std::string robot = registration.substr(kBefore.size(), end - kBefore.size());
    RemoteConnection connection;
    std::string error = connection.Connect(server);
    if (error.empty()) error = connection.Open(robot + "/pose");
    Message get_pose, reply;
    get_pose.command = command::kGetPose;
    if (error.empty()) error = connection.Call(get_pose, reply);
    if (error.empty() && reply.error != 0) error = reply.text;
    return Say(robot.substr(1) + " says where it is", error) ? kExitOk : kExitErrors;
  }
  Print("ok       the scenario has no robots\n");
  return kExitOk;
}

}  // namespace

int Doctor(const RemoteOptions& options) {
  const auto server = ParseServerAddress(options.server);
  if (!server) {
    PrintError("coopdyn: --server is HOST or HOST:PORT, e.g. labserver:10000, not {}\n", options.server);
    return kExitWrongUse;
  }
  RemoteConnection names;
  const std::string place = server->host + ":" + std::to_string(server->port);
  if (!Say("the daemon's name port answers at " + place, names.Connect(*server))) return kExitNoDaemon;
  std::vector<std::string> lines;
  std::string error = names.AskNames("list", lines);
  if (error.empty() && lines.empty()) error = "it knows no names: is this port a coopdyn daemon?";
  if (!Say("it lists " + std::to_string(lines.size()) + " names", error)) return kExitErrors;
  if (!Say("OPEN gives /simulation", names.Open("/simulation"))) return kExitErrors;
  Message describe, reply;
  describe.command = command::kDescribe;
  error = names.Call(describe, reply);
  if (error.empty() && reply.text.find("\"protocol\":1") == std::string::npos &&
      reply.text.find("\"protocol\": 1") == std::string::npos) {
    error = "it speaks another protocol than 1: use the client of the daemon's own version";
  }
  if (!Say("it speaks protocol 1", error)) return kExitErrors;
  const double round_trip_us = MedianRoundTrip(names);
  const std::string text = fmt::format("a round trip takes {:.0f} us (median of {})", round_trip_us, kPings);
  if (!Say(text, round_trip_us < 0 ? "a ping was not answered" : "")) return kExitErrors;
  if (round_trip_us > 20000) Print("         that is slow: a far or wireless network limits lockstep\n");
  return VisitRobot(*server, lines);
}

}  // namespace coopdyn

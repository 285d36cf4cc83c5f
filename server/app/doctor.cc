// SPDX-License-Identifier: MIT
#include <algorithm>
#include <functional>
#include <optional>
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

/// Runs one part of the walk and prints its result, or that `what` failed.
void Walk(const std::string& what, const std::function<std::string()>& part) {
  try {
    Print("ok       {}\n", part());
  } catch (const RemoteError& error) {
    Print("FAILED   {}: {}\n", what, error.what());
    throw;
  }
}

/// The median round trip of a ping, in microseconds.
double MedianRoundTrip(RemoteConnection& connection) {
  const SteadyClock clock;
  std::vector<Nanoseconds> times;
  Message ping;
  ping.command = command::kPing;
  for (int i = 0; i < kPings; ++i) {
    const Nanoseconds before = clock.Now();
    if (connection.Call(ping).error != 0) throw RemoteError(kExitErrors, "a ping was not answered");
    times.push_back(clock.Now() - before);
  }
  std::nth_element(times.begin(), times.begin() + kPings / 2, times.end());
  return static_cast<double>(times[kPings / 2]) * 1e-3;
}

/// Requests the pose of the first robot in the list.
void VisitRobot(const ServerAddress& server, const std::vector<std::string>& registrations) {
  constexpr std::string_view kBefore = "registration name ", kModule = "/pose ";
  for (const std::string& registration : registrations) {
    const std::size_t end = registration.find(kModule);
    if (!registration.starts_with(kBefore) || end == std::string::npos) continue;
    const std::string robot = registration.substr(kBefore.size(), end - kBefore.size());
    const std::string what = robot.substr(1) + " says where it is";
    return Walk(what, [&] {
      RemoteConnection connection(server);
      connection.Open(robot + "/pose");
      Message get_pose;
      get_pose.command = command::kGetPose;
      if (const Message reply = connection.Call(get_pose); reply.error != 0) {
        throw RemoteError(kExitErrors, reply.text);
      }
      return what;
    });
  }
  Print("ok       the scenario has no robots\n");
}

int Doctor(const ServerOptions& options) {
  try {
    const ServerAddress server(options.server, options.seat);
    const std::string place = server.host + ":" + std::to_string(server.port);
    std::optional<RemoteConnection> names;
    Walk("the daemon's name port answers at " + place, [&] {
      names.emplace(server);
      return "the daemon's name port answers at " + place;
    });
    std::vector<std::string> lines;
    Walk("it lists its names", [&] {
      lines = names->AskNames("list");
      if (lines.empty()) throw RemoteError(kExitErrors, "it knows no names: is this port a coopdyn daemon?");
      return fmt::format("it lists {} names", lines.size());
    });
    Walk("OPEN gives /simulation", [&] {
      names->Open("/simulation");
      return "OPEN gives /simulation";
    });
    Walk("it speaks protocol 1", [&] {
      Message describe;
      describe.command = command::kDescribe;
      const std::string text = names->Call(describe).text;
      if (text.find("\"protocol\":1") == std::string::npos &&
          text.find("\"protocol\": 1") == std::string::npos) {
        throw RemoteError(kExitErrors,
                          "it speaks another protocol than 1: use the client of the daemon's own version");
      }
      return "it speaks protocol 1";
    });
    double round_trip_us = 0;
    Walk("a round trip", [&] {
      round_trip_us = MedianRoundTrip(*names);
      return fmt::format("a round trip takes {:.0f} us (median of {})", round_trip_us, kPings);
    });
    if (round_trip_us > 20000) Print("         that is slow: a far or wireless network limits lockstep\n");
    VisitRobot(server, lines);
    return kExitOk;
  } catch (const RemoteError& error) {
    if (error.code == kExitWrongUse) PrintError("coopdyn: {}\n", error.what());
    return error.code;
  }
}

}  // namespace

void AddDoctor(CLI::App& app, Chosen& chosen) {
  CLI::App* sub = app.add_subcommand("doctor", "Find out why a client cannot connect");
  sub->footer("Example: coopdyn doctor --server labserver:10000");
  sub->callback(
      [options = AddServerOptions(*sub), &chosen] { chosen = [options] { return Doctor(*options); }; });
}

}  // namespace coopdyn

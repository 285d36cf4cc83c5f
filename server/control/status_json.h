// SPDX-License-Identifier: MIT
// The answer to get_status: one JSON object (DESIGN §10). Every object of a list has the same keys; what is
// absent or not finite is null; `speed` null = no limit. Pure; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/devices/connection_roster.h"
#include "server/state/command_board.h"
#include "server/state/run_control.h"

namespace coopdyn {

struct StatusInput {
  struct Module {
    std::string name;  // "/robot1/motors"
    std::string type;  // motors
    int port = 0;      // 0: reached through OPEN only
  };
  struct Robot {
    std::string name, type;
    std::vector<Module> modules;
    std::string owner;  // client name, else peer; empty: nobody
    bool participates = false;
    bool dropped = false;
    bool still_moving = false;  // nobody drives it, and its set-points are not zero
  };
  struct Connection {
    ConnectionRoster::Entry entry;
    bool owner = false;
  };

  std::string version;
  std::string scenario;
  std::uint64_t seed = 0;
  RunStatus run;
  std::uint64_t step = 0, revision = 0;
  double time_s = 0;
  std::string hash;           // 16 hex digits; empty: null
  std::vector<Robot> robots;  // those asked for
  std::size_t robot_count = 0;
  std::vector<Connection> clients;
  std::size_t client_count = 0;
  std::vector<Awaited> awaiting;  // the first 20
  std::size_t awaiting_count = 0;
  std::string recording;  // file; empty: null
  std::uint64_t recording_lost = 0;
  std::string recording_stall;  // empty: null
  std::optional<PlaybackStatus> playback;
  std::string http;  // URL of the page; empty: null
  std::vector<Event> events;
};

std::string StatusJson(const StatusInput& status);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// What every robot of one daemon shares. Constant; any thread. All that it refers to outlives the robots.
#pragma once

#include <string>

#include "server/base/clock.h"
#include "server/devices/connection_roster.h"
#include "server/devices/device_factory.h"
#include "server/devices/token_guard.h"
#include "server/naming/name_table.h"
#include "server/net/net_services.h"
#include "server/state/command_board.h"
#include "server/state/frame_board.h"

namespace coopdyn {

struct RobotServices {
  CommandBoard& board;
  const FrameBoard& frames;
  NameTable& names;
  NetServices& net;
  ConnectionRoster& roster;
  const DeviceFactory& devices;
  const TokenGuard& guard;  // required: `--private`
  const Clock& clock;
  std::string version;
};

}  // namespace coopdyn

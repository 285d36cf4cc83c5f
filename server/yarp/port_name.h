// SPDX-License-Identifier: MIT
// The names of YARP's ports for a module: /robot1/pose itself, /robot1/pose/state:o, /robot1/pose/10/state:o,
// /robot1/motors/command:i; those that YARP's own devices have; and /clock. Pure functions; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "protocol/command_table.h"

namespace coopdyn {

struct YarpPortName {
  std::string_view module;  // "/robot1/pose"
  std::string_view
      subject;         // "state": the first reading; "scan": that of get_scan; or the whole end: "command:i"
  bool takes = false;  // requests or commands go in. Else readings come out
  std::int32_t every = 1;  // steps, between two readings

  /// It is a port of the module at `path`, which has the commands of `table`: /robot1/base is the drive.
  bool IsOf(std::string_view path, const CommandTable& table) const;
};

/// Nothing: it is no name of a port of ours, as a module's own name is not.
std::optional<YarpPortName> ParseYarpPortName(std::string_view name);

/// How a port writes its reading.
enum class YarpSample {
  kReading,         // text, params, data
  kParams,          // the params alone
  kBoardPositions,  // of get_board the positions, as a control board does
  kBoard,           // and all that a control board sends
  kMeasures,        // of multipleAnalogSensors
  kInertial,        // twelve numbers of an IMU
  kLaserScan,
  kOdometry,
  kBattery,
  kImage,
  kDepth,
};
/// What a port sends.
struct YarpStream {
  std::int32_t reading = 0;  // a get-command
  std::int32_t every = 1;    // steps
  YarpSample sample = YarpSample::kReading;
};

/// The simulated time, as YARP_CLOCK reads it: that of /simulation, and the requests to it.
inline constexpr std::string_view kYarpClock = "/clock", kYarpClockRpc = "/clock/rpc";
/// Makes things in the world, as gazebo-yarp-plugins does: for /world.
inline constexpr std::string_view kYarpWorldInterface = "/world_input_port";
/// Of the port `name` of a module with these commands, or of that module itself. Nothing: it has no such
/// reading.
std::optional<YarpStream> StreamOf(std::string_view name, const CommandTable& table);

/// In which words a port that takes something is spoken to.
enum class YarpTalk {
  kModule,  // those of its module
  kClock,
  kBoardWords,   // a control board of YARP 3
  kBoardRpc,     // of YARP 4
  kBoardStream,  // of both
  kMetadata,     // of multipleAnalogSensors
  kAnalog,
  kBattery,
  kLidar,
  kOdometry,
  kCamera,
  kWorld,    // the world interface of gazebo-yarp-plugins
  kBase,     // commands of baseControl
  kBaseRpc,  // of mobileBaseVelocityControl
};
/// Nothing: a module with these commands has no such port.
std::optional<YarpTalk> TalkOf(std::string_view name, const CommandTable& table);

/// A module with these commands has this port.
inline bool HasYarpPort(const YarpPortName& port, std::string_view name, std::string_view path,
                        const CommandTable& table) {
  return port.IsOf(path, table) &&
         (port.takes ? TalkOf(name, table).has_value() : StreamOf(name, table).has_value());
}

}  // namespace coopdyn

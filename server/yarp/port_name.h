// SPDX-License-Identifier: MIT
// The names of YARP's ports for a module: /robot1/pose itself, /robot1/pose/state:o, /robot1/pose/10/state:o,
// /robot1/motors/command:i, the names of YARP's own devices, and /clock. Pure functions; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "protocol/command_table.h"

namespace coopdyn {

struct YarpPortName {
  std::string_view module;   // "/robot1/pose"
  std::string_view subject;  // "state": the first reading; "scan": that of get_scan; an input's whole suffix:
                             // "command:i"
  bool takes = false;        // an input for requests or commands; else sends readings
  std::int32_t every = 1;    // steps between two readings

  /// True if it is a port of the module at `path` with command table `table`; /robot1/base belongs to the
  /// drive.
  bool IsOf(std::string_view path, const CommandTable& table) const;
};

/// Nullopt if `name` is not a port of ours; also for a module's own name.
std::optional<YarpPortName> ParseYarpPortName(std::string_view name);

/// How a port writes its reading.
enum class YarpSample {
  kReading,         // text, params, data
  kParams,          // only the params
  kBoardPositions,  // positions of get_board, like a control board
  kBoard,           // complete state of a control board
  kMeasures,        // of multipleAnalogSensors
  kInertial,        // twelve numbers of an IMU
  kLaserScan,
  kOdometry,
  kBattery,
  kImage,
  kDepth,
};
/// The stream of a port.
struct YarpStream {
  std::int32_t reading = 0;  // id of a get-command
  std::int32_t every = 1;    // steps
  YarpSample sample = YarpSample::kReading;
};

/// The simulated time as read by YARP_CLOCK, and requests to the clock; both of /simulation.
inline constexpr std::string_view kYarpClock = "/clock", kYarpClockRpc = "/clock/rpc";
/// Makes things in the world, like gazebo-yarp-plugins; of /world.
inline constexpr std::string_view kYarpWorldInterface = "/world_input_port";
/// The stream of port `name` of a module with this command table, or of the module's own port. Nullopt if
/// there is no such reading.
std::optional<YarpStream> StreamOf(std::string_view name, const CommandTable& table);

/// The language of an input port.
enum class YarpTalk {
  kModule,  // its module's commands
  kClock,
  kBoardWords,   // control board of YARP 3
  kBoardRpc,     // control board of YARP 4
  kBoardStream,  // control board of both
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
/// Nullopt if a module with this command table has no such port.
std::optional<YarpTalk> TalkOf(std::string_view name, const CommandTable& table);

/// True if the module with this command table has this port.
inline bool HasYarpPort(const YarpPortName& port, std::string_view name, std::string_view path,
                        const CommandTable& table) {
  return port.IsOf(path, table) &&
         (port.takes ? TalkOf(name, table).has_value() : StreamOf(name, table).has_value());
}

}  // namespace coopdyn

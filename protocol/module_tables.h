// SPDX-License-Identifier: MIT
// The modules' command tables: the only declaration of each command's arguments and reply. The server's
// modules, `describe`, the text form, the clients' tests and docs/protocol.md all follow them. Pure; any
// thread.
#pragma once

#include <string_view>
#include <vector>

#include "protocol/command_table.h"

namespace coopdyn {

CommandTable MotorsTable();      // /R/motors
CommandTable JointsTable();      // /R/joints, or the name of the group
CommandTable MusclesTable();     // /R/muscles
CommandTable ThrustersTable();   // /R/thrusters
CommandTable DistanceTable();    // /R/distance
CommandTable TargetTable();      // /R/target
CommandTable PoseTable();        // /R/pose
CommandTable NeighboursTable();  // /R/neighbours
CommandTable CompassTable();     // /R/compass
CommandTable SupportTable();     // /R/support
CommandTable ImuTable();         // /R/imu
CommandTable WrenchTable();      // /R/wrench
CommandTable LidarTable();       // /R/lidar
CommandTable ContactTable();     // /R/contact
CommandTable SonarTable();       // /R/sonar
CommandTable InfraredTable();    // /R/infrared
CommandTable LightTable();       // /R/light
CommandTable CameraTable();      // /R/camera
CommandTable BatteryTable();     // /R/battery
CommandTable OdometryTable();    // /R/odometry
CommandTable ChannelTable();     // /R/channel
CommandTable SimulationTable();  // /simulation
CommandTable WorldTable();       // /world
CommandTable SwarmTable();       // /swarm
CommandTable RecorderTable();    // /recorder
CommandTable PlaybackTable();    // /playback

/// All of the above, in that order.
const std::vector<CommandTable>& AllModuleTables();
/// The table of modules named `name`; null if unknown.
const CommandTable* FindModuleTable(std::string_view name);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Readings of sensors out of the data of replies.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "clients/cpp/sensors.h"

namespace coopdyn::client {

struct RobotLink;

/// @pre there are ten numbers; likewise six, three and five below
Imu ToImu(std::span<const double> d);
Wrench ToWrench(std::span<const double> d);
Battery ToBattery(std::span<const double> d);
Odometry ToOdometry(std::span<const double> d);
/// Seven numbers each, without ids and names.
std::vector<Contact> ToContacts(std::span<const double> d);
/// The ranges of a lidar; its angles are asked for once.
Scan ToScan(RobotLink& link, const std::string& module, std::span<const double> ranges);

}  // namespace coopdyn::client

// SPDX-License-Identifier: MIT
// Converts the data of replies to sensor readings.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "clients/cpp/sensors.h"

namespace coopdyn::client {

struct RobotLink;

/// @pre 10 numbers; below 6, 3 and 5
Imu ToImu(std::span<const double> d);
Wrench ToWrench(std::span<const double> d);
Battery ToBattery(std::span<const double> d);
Odometry ToOdometry(std::span<const double> d);
/// Seven numbers per contact; the result has no ids and names.
std::vector<Contact> ToContacts(std::span<const double> d);
/// Adds the lidar's angles, which are queried once, to its ranges.
Scan ToScan(RobotLink& link, const std::string& module, std::span<const double> ranges);

}  // namespace coopdyn::client

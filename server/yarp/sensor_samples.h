// SPDX-License-Identifier: MIT
// Sensor readings as sent by YARP's own devices. Pure functions; any thread.
//
// The layouts follow multipleAnalogSensorsSerializations.thrift, LaserScan2D.thrift and OdometryData.thrift
// of YARP 3.12 and 4.0, which are the same, and Image of libYARP_sig.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "protocol/message.h"
#include "server/yarp/bottle.h"
#include "server/yarp/port_name.h"

namespace coopdyn {

/// Appends `reading`, a push or reply that ends with time_s and step, in the format of `sample`. `geometry`:
/// the reply to get_scan_geometry, for kLaserScan. Returns false if the reading does not fit.
bool AppendSensorSample(YarpSample sample, const Message& reading, const Message& geometry,
                        YarpDialect dialect, std::string& out);

/// The reply to getMetadata of a module of this kind ("imu") with this name.
std::string MeasuresMetadata(std::string_view kind, std::string_view name);

/// The angles of a scan, and its row closest to horizontal.
struct ScanLimits {
  double first_deg = 0, increment_deg = 0;
  double end_deg = 0;  // one increment after the last ray: YARP assumes rays (end - first) / columns apart
  double min_range_m = 0, max_range_m = 0;
  std::size_t columns = 0, row = 0;
};
/// Parses a reply to get_scan_geometry; nullopt if malformed.
std::optional<ScanLimits> ReadScanGeometry(const Message& geometry);

}  // namespace coopdyn

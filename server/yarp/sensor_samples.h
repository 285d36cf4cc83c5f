// SPDX-License-Identifier: MIT
// Readings of sensors as YARP's own devices send them. Pure functions; any thread.
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

/// Appends the bytes of `reading`, a push or reply with time_s and step at its end, as `sample` says.
/// `geometry`: the reply to get_scan_geometry, of kLaserScan. False: the reading is none of that kind.
bool AppendSensorSample(YarpSample sample, const Message& reading, const Message& geometry,
                        YarpDialect dialect, std::string& out);

/// The reply to getMetadata of a module of this kind ("imu") and this name.
std::string MeasuresMetadata(std::string_view kind, std::string_view name);

/// The row of a scan that is nearest to level, and its angles.
struct ScanLimits {
  double first_deg = 0, increment_deg = 0;
  double end_deg = 0;  // of a ray after the last: YARP takes two rays to be (end - first) / columns apart
  double min_range_m = 0, max_range_m = 0;
  std::size_t columns = 0, row = 0;
};
/// Of a reply to get_scan_geometry. Nothing: it is none.
std::optional<ScanLimits> ReadScanGeometry(const Message& geometry);

}  // namespace coopdyn

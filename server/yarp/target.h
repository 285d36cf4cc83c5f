// SPDX-License-Identifier: MIT
// Parses the target of `[add] "tcp://reader"`. Pure functions; any thread.
#pragma once

#include <string>

#include "server/yarp/carrier.h"

namespace coopdyn {

/// The destination and carrier of a connection.
struct YarpTarget {
  std::string name;           // "/reader"
  std::string carrier_words;  // "tcp+recv.portmonitor"
  YarpCarrier carrier = YarpCarrier::kTcp;
  std::string qualifiers;  // " (recv portmonitor)"
  std::string problem;     // why the connection is not possible; empty if it is
};

/// "tcp+recv.portmonitor+type.lua://reader": plug-ins of the reader are appended to our name in the hello.
/// Other plug-ins would run in the daemon and are refused.
YarpTarget ParseYarpTarget(const std::string& text);

}  // namespace coopdyn

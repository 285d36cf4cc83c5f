// SPDX-License-Identifier: MIT
// What `[add] "tcp://reader"` names. Pure functions; any thread.
#pragma once

#include <string>

#include "server/yarp/carrier.h"

namespace coopdyn {

/// Where a connection goes to, and how.
struct YarpTarget {
  std::string name;           // "/reader"
  std::string carrier_words;  // "tcp+recv.portmonitor"
  YarpCarrier carrier = YarpCarrier::kTcp;
  std::string qualifiers;  // " (recv portmonitor)"
  std::string problem;     // why it cannot be; empty: it can
};

/// "tcp+recv.portmonitor+type.lua://reader": plug-ins of the reader are told to it after our name. Others
/// would run here.
YarpTarget ParseYarpTarget(const std::string& text);

}  // namespace coopdyn

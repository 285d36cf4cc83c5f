// SPDX-License-Identifier: MIT
// How this user's YARP programs find their name server: the file that `yarp conf` writes.
#pragma once

#include <functional>
#include <string>

namespace coopdyn {

/// The value of an environment variable; empty if not set.
using Environment = std::function<std::string(const char* name)>;

/// The file's path: yarp.conf, or _lab.conf with YARP_NAMESPACE=/lab, in YARP_CONFIG_HOME,
/// XDG_CONFIG_HOME/yarp or ~/.config/yarp.
std::string YarpConfFile(const Environment& environment);
/// Parses the file's `text`: "HOST PORT yarp", or lines `host` and `port`. Returns "HOST:PORT", empty if it
/// names no server.
std::string ServerInYarpConf(const std::string& text);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// Where YARP's programs of this user find their name server: the file that `yarp conf` writes.
#pragma once

#include <functional>
#include <string>

namespace coopdyn {

/// The value of an environment variable; empty: it is not set.
using Environment = std::function<std::string(const char* name)>;

/// The file: yarp.conf, or _lab.conf with YARP_NAMESPACE=/lab, in YARP_CONFIG_HOME, XDG_CONFIG_HOME/yarp or
/// ~/.config/yarp.
std::string YarpConfFile(const Environment& environment);
/// Reads `text` of such a file: "HOST PORT yarp", or lines `host` and `port`. Returns "HOST:PORT", empty if
/// it has none.
std::string ServerInYarpConf(const std::string& text);

}  // namespace coopdyn

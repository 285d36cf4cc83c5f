// SPDX-License-Identifier: MIT
// YARP ports that are open because a program has asked for their names. Unused ports close.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/yarp/yarp_port.h"

namespace coopdyn {

/// One thread: control, or main at start and end.
class YarpPorts {
 public:
  /// Most ports without connection, per address and in total; beyond that the port not asked for the longest
  /// closes.
  static constexpr std::size_t kMaxUnused = 64, kMaxUnusedOfAll = 256;
  /// A port closes after it has had no connection and no request for its name for this long.
  static constexpr Nanoseconds kKeptFor = 30 * kNanosecondsPerSecond;

  /// The ports listen at `addresses`. `net` and `names` outlive it.
  YarpPorts(std::vector<std::string> addresses, NetServices& net, NameTable& names)
      : addresses_(std::move(addresses)), net_(net), names_(names) {}

  /// Opens `name` if it is a port of `module`; its connections are served on `io`. `asker`: the address of
  /// the program that asks; if empty, the port stays open as long as its module.
  void Open(const std::string& name, Endpoint& module, IoThread& io, const std::string& asker);
  /// True if the port stays open as long as its module.
  bool IsKept(const std::string& name) const;
  /// Closes the ports of `module` with this notice; call it before the module ends.
  void CloseOf(const Endpoint& module, const std::string& notice);
  void CloseUnused(Nanoseconds now);
  bool empty() const { return ports_.empty(); }

 private:
  struct Held {
    std::unique_ptr<YarpPort> port;
    const Endpoint* module;
    std::string asker;  // empty: stays open
  };
  bool IsUnused(const Held& held) const { return !held.asker.empty() && held.port->session_count() == 0; }
  /// When a program last asked for the name.
  Nanoseconds AskedAt(const std::string& name) const;
  /// Closes a port without connection if the number for `asker`, or in total, is at its limit.
  void MakeRoom(const std::string& asker);

  const std::vector<std::string> addresses_;
  NetServices& net_;
  NameTable& names_;
  std::map<std::string, Held> ports_;  // by name
};

}  // namespace coopdyn

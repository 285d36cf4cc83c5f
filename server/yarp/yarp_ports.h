// SPDX-License-Identifier: MIT
// The ports of YARP that are open because somebody has asked for their names. They close when nobody uses
// them.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/yarp/yarp_port.h"

namespace coopdyn {

/// One thread (control; at start and end main).
class YarpPorts {
 public:
  /// Ports without a connection that one address may have, and all together: beyond it the one that nobody
  /// has asked for longest closes.
  static constexpr std::size_t kMaxUnused = 64, kMaxUnusedOfAll = 256;
  /// A port closes when it has had no connection for so long, and nobody has asked for its name.
  static constexpr Nanoseconds kKeptFor = 30 * kNanosecondsPerSecond;

  /// They listen at `addresses`. `net` and `names` outlive it.
  YarpPorts(std::vector<std::string> addresses, NetServices& net, NameTable& names)
      : addresses_(std::move(addresses)), net_(net), names_(names) {}

  /// Opens `name` if it is a port of `module`, whose connections live on `io`. Empty `asker`: it stays as
  /// long as its module. Else: the address that asks.
  void Open(const std::string& name, Endpoint& module, IoThread& io, const std::string& asker);
  /// It is open as long as its module.
  bool IsKept(const std::string& name) const;
  /// Closes those of `module`, with this notice: before the module ends.
  void CloseOf(const Endpoint& module, const std::string& notice);
  void CloseUnused(Nanoseconds now);
  bool empty() const { return ports_.empty(); }

 private:
  struct Held {
    std::unique_ptr<YarpPort> port;
    const Endpoint* module;
    std::string asker;  // empty: kept
  };
  bool IsUnused(const Held& held) const { return !held.asker.empty() && held.port->session_count() == 0; }
  /// When somebody asked for that name last.
  Nanoseconds AskedAt(const std::string& name) const;
  /// Closes one of those without a connection if `asker` has, or all have, as many as may be.
  void MakeRoom(const std::string& asker);

  const std::vector<std::string> addresses_;
  NetServices& net_;
  NameTable& names_;
  std::map<std::string, Held> ports_;  // by name
};

}  // namespace coopdyn

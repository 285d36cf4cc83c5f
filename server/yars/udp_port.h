// SPDX-License-Identifier: MIT
// A robot's UDP port for clients of the YARS of 2008: datagrams to and from its module `channel`.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/base/mutex.h"
#include "server/net/endpoint.h"
#include "server/net/io_thread.h"
#include "server/net/net_services.h"
#include "server/yars/udp_talk.h"
#include "server/yars/world.h"

namespace coopdyn {

class YarsUdpPort;

/// The daemon's ports, by number: the world's answer goes to the robot that has the port by then.
/// Thread-safe.
class YarsPorts {
 public:
  /// All arguments outlive it; `control` has stopped when it is destroyed.
  YarsPorts(YarsWorld& world, IoThread& control, NetServices& net);
  ~YarsPorts();
  YarsPorts(const YarsPorts&) = delete;
  YarsPorts& operator=(const YarsPorts&) = delete;
  YarsWorld& world() { return world_; }
  /// The robot on `port` has been removed. Until another robot opens the port, clients may reset the world
  /// through it; any other request is refused with that advice. Control thread.
  void Vacate(const std::vector<std::string>& addresses, int port);

 private:
  friend class YarsUdpPort;
  struct Client;
  struct Left;
  struct Shared;
  Left TakeLeft(int port);

  YarsWorld& world_;
  IoThread& control_;
  NetServices& net_;
  const std::shared_ptr<Shared> shared_;
  const std::unique_ptr<Endpoint> nobody_;  // stands in for a removed robot
  // Control thread, or a robot's thread while the control thread waits for it.
  std::map<int, Left> left_;  // by port without robot, until the next robot opens it
  std::map<int, std::unique_ptr<YarsUdpPort>> vacant_;
};

/// One client at a time: the first to register, until it leaves or is silent for long. Opened on the control
/// thread, destroyed on the thread `io` or after it has stopped.
class YarsUdpPort {
 public:
  /// Listens on `port` of all `addresses`, and continues with the client of the port's previous robot. Null
  /// with `error` on failure. All arguments outlive it.
  static std::unique_ptr<YarsUdpPort> Open(std::string robot, Endpoint& channel, IoThread& io,
                                           NetServices& net, YarsPorts& ports,
                                           const std::vector<std::string>& addresses, int port,
                                           std::string& error);
  ~YarsUdpPort();
  YarsUdpPort(const YarsUdpPort&) = delete;
  YarsUdpPort& operator=(const YarsUdpPort&) = delete;

  class Impl;

 private:
  explicit YarsUdpPort(std::shared_ptr<Impl> impl);

  const std::shared_ptr<Impl> impl_;
};

}  // namespace coopdyn

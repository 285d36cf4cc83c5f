// SPDX-License-Identifier: MIT
// The UDP port of a robot for clients of YARS of 2008: datagrams to and from its module `channel`.
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

/// The ports of a daemon, by their numbers: an answer of the world finds whichever robot is there by then.
/// Any thread.
class YarsPorts {
 public:
  /// All outlive it; `control` has stopped when it is destroyed.
  YarsPorts(YarsWorld& world, IoThread& control, NetServices& net);
  ~YarsPorts();
  YarsPorts(const YarsPorts&) = delete;
  YarsPorts& operator=(const YarsPorts&) = delete;
  YarsWorld& world() { return world_; }
  /// The robot on `port` is gone: until another one opens it, clients may reset there, and are told so
  /// whatever else they ask. Control thread.
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
  const std::unique_ptr<Endpoint> nobody_;  // in place of a robot that is gone
  // Control thread, or a robot's while that one waits for it.
  std::map<int, Left> left_;  // by ports without a robot, until the next one is there
  std::map<int, std::unique_ptr<YarsUdpPort>> vacant_;
};

/// One client at a time: whoever registers first, until it is silent for long or leaves. Opened on the
/// control thread, destroyed on the thread `io` or when that has stopped.
class YarsUdpPort {
 public:
  /// Listens on `port` of all `addresses`, and goes on with the client of the robot before it. Null with
  /// `error`. All outlive it.
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

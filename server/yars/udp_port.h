// SPDX-License-Identifier: MIT
// The UDP port of a robot for clients of YARS of 2008: datagrams to and from its module `channel`.
#pragma once

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
  /// `world` outlives it.
  explicit YarsPorts(YarsWorld& world) : world_(world) {}
  YarsWorld& world() { return world_; }

 private:
  friend class YarsUdpPort;
  struct Shared;

  YarsWorld& world_;
  const std::shared_ptr<Shared> shared_ = MakeShared();
  static std::shared_ptr<Shared> MakeShared();
};

/// One client at a time: whoever registers first, until it is silent for long or leaves. Opened on any
/// thread, destroyed on the thread `io` or when that has stopped.
class YarsUdpPort {
 public:
  /// Listens on `port` of all `addresses`. Null with `error`. All outlive it.
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

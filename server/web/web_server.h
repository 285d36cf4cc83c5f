// SPDX-License-Identifier: MIT
// The UI thread: HTTP and WebSocket on one port, the page, pictures, and the bridge from JSON to the modules. Whatever
// the page does to the world goes over the module protocol, on a socket pair that the module adopts, so that the rules
// of ownership, lockstep and rights are the modules' own. Nothing blocks this thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/base/log.h"

namespace coopdyn {

class ImageBoard;
class NameTable;

struct WebOptions {
  /// IP addresses to listen on; the first must work, a further one may be missing (no IPv6 here).
  std::vector<std::string> addresses{"127.0.0.1", "::1"};
  /// 0: any free one; all addresses get the same.
  std::uint16_t port = 10001;
  /// Names under which a browser may ask for this daemon, besides IP addresses and "localhost": those of `--host` and
  /// `--advertise`, and the machine's own. Any other Host header is refused, as a guard against DNS rebinding.
  std::vector<std::string> host_names;
  /// What changing requests from beyond loopback must carry; empty: they are all refused.
  std::string token;
  /// Shown by the page.
  std::string version;
  /// Names of the scenarios that can be loaded by name. Called on the UI thread; must not block for long.
  std::function<std::vector<std::string>()> scenarios;
  /// The port of the names, for the connection lines on the page; 0: off.
  std::uint16_t name_port = 0;
};

class WebServer {
 public:
  /// Binds and listens; nobody is served before Start(). `images` is null without rendering.
  /// Both are used until Stop() has returned.
  /// @throws std::system_error if the first address cannot be bound (EADDRINUSE: the port is busy).
  WebServer(WebOptions options, NameTable& names, ImageBoard* images, Logger logger);
  /// Stops.
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// Starts the UI thread.
  void Start();
  /// Closes all connections and joins the thread. Pictures that are still being made are dropped when they come.
  void Stop();

  /// The port in use.
  std::uint16_t port() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coopdyn

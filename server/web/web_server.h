// SPDX-License-Identifier: MIT
// The UI thread: HTTP and WebSocket on one port, the page, pictures, and the bridge from JSON to the modules.
// The page acts on the world only through the module protocol, on a socket pair that the module adopts: the
// modules themselves enforce ownership, lockstep and rights. Nothing blocks this thread.
#pragma once

#include <string>
#include <vector>

#include "server/net/io_thread.h"
#include "server/net/listener.h"
#include "server/web/web_context.h"

namespace coopdyn {

class WebServer {
 public:
  /// Starts the UI thread, which serves nobody before Listen(). `images`: null without rendering. All
  /// references must live until Stop() has returned.
  WebServer(WebOptions options, const NameTable& names, const FrameBoard& frames, ImageBoard* images,
            NetServices& services);
  ~WebServer() { Stop(); }
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// Listener::Listen(): returns an error text, empty if it listens. Any thread, once.
  std::string Listen(const std::vector<std::string>& addresses, int port) {
    return listener_.Listen(addresses, port);
  }
  /// The port it listens on; 0 = none. Constant after Listen().
  int port() const { return listener_.port(); }

  /// Serves a connection that another process accepted and whose first bytes it has read. Any thread.
  void Adopt(UniqueFd fd, PeerInfo peer, std::string already_read);

  /// Closes all connections and joins the thread. Drops pictures that are still being made. Any thread but
  /// the UI thread; further calls do nothing.
  void Stop();

 private:
  void Accept(UniqueFd fd, PeerInfo peer, std::string already_read = {});

  NetServices& services_;
  IoThread thread_;  // before the rest: remaining connections end with its io_context
  WebContext context_;
  Listener listener_;
  bool stopped_ = false;
};

}  // namespace coopdyn

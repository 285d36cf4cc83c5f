// SPDX-License-Identifier: MIT
// The UI thread: HTTP and WebSocket on one port, the page, pictures, and the bridge from JSON to the modules.
// Whatever the page does to the world goes over the module protocol, on a socket pair that the module adopts,
// so that the rules of ownership, lockstep and rights are the modules' own. Nothing blocks this thread.
#pragma once

#include <string>
#include <vector>

#include "server/net/io_thread.h"
#include "server/net/listener.h"
#include "server/web/web_context.h"

namespace coopdyn {

class WebServer {
 public:
  /// Starts the UI thread; nobody is served before Listen(). `images` is null without rendering. `frames`
  /// says whether there is anything new to show. All are used until Stop() has returned.
  WebServer(WebOptions options, const NameTable& names, const FrameBoard& frames, ImageBoard* images,
            NetServices& services);
  /// Stops.
  ~WebServer() { Stop(); }
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// Listener::Listen(): returns an error text, empty if it listens. Any thread, once.
  std::string Listen(const std::vector<std::string>& addresses, int port) {
    return listener_.Listen(addresses, port);
  }
  /// The port it listens on; 0 = none. Constant after Listen().
  int port() const { return listener_.port(); }

  /// Serves a connection that another process has accepted, and of which it has read the first bytes. Any
  /// thread.
  void Adopt(UniqueFd fd, PeerInfo peer, std::string already_read);

  /// Closes all connections and joins the thread. Pictures that are still being made are dropped when they
  /// come. Any thread but the UI thread; again does nothing.
  void Stop();

 private:
  void Accept(UniqueFd fd, PeerInfo peer, std::string already_read = {});

  NetServices& services_;
  IoThread thread_;  // first: connections that are left end with its io_context
  WebContext context_;
  Listener listener_;
  bool stopped_ = false;
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// State shared by all connections of the web server. UI thread.
#pragma once

#include <utility>

#include <boost/asio/io_context.hpp>
#include <string>
#include <string_view>

#include "server/naming/name_table.h"
#include "server/net/net_services.h"
#include "server/web/access.h"
#include "server/web/page_files.h"
#include "server/web/people.h"
#include "server/web/pictures.h"
#include "server/web/run_files.h"
#include "server/web/sensor_feed.h"
#include "server/web/status_feed.h"
#include "server/web/web_connections.h"
#include "server/web/web_options.h"

namespace coopdyn {

/// Numbers the scenes, so that viewers know when to ask for a new one. UI thread.
class SceneNumbers {
 public:
  std::uint32_t Of(const std::shared_ptr<const Scene>& scene) {
    if (scene != newest_) {
      newest_ = scene;
      ++number_;
    }
    return number_;
  }

 private:
  std::shared_ptr<const Scene> newest_;
  std::uint32_t number_ = 0;
};

struct WebContext {
  WebContext(boost::asio::io_context& io_context, WebOptions web_options, const NameTable& name_table,
             const FrameBoard& frame_board, ImageBoard* images, NetServices& net_services)
      : io(io_context),
        options(std::move(web_options)),
        names(name_table),
        frames(frame_board),
        services(net_services),
        pictures(io_context, frame_board, images),
        runs(io_context, options.runs, net_services.logger()),
        files(io_context, options.files),
        status(io_context, name_table),
        connections(options.limits) {}

  boost::asio::io_context& io;
  const WebOptions options;
  const NameTable& names;
  const FrameBoard& frames;
  NetServices& services;
  Pictures pictures;
  RunFiles runs;
  PageFiles files;
  StatusFeed status;
  WebConnections connections;
  SceneNumbers scenes;
  SensorFeed sensors;
  People people;
  CostBook costs;

  /// Whether `given` is the token. Counts wrong tokens of `peer`; after some, refuses its tokens for a while.
  bool TakesToken(std::string_view given, const std::string& peer) const {
    if (given.empty() || options.guard == nullptr) return false;
    return options.guard->Judge(given, peer, services.clock().Now()) == TokenVerdict::kRight;
  }
  /// The text for `peer` if its tokens are refused unread for now; empty if they are read.
  std::string TokenWaitText(const std::string& peer) const {
    return options.guard == nullptr ? "" : options.guard->WaitText(peer, services.clock().Now());
  }
};

}  // namespace coopdyn

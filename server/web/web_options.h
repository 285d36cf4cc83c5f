// SPDX-License-Identifier: MIT
// Options of the web server.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "server/base/wrong_tokens.h"
#include "server/web/costs.h"
#include "server/web/http_routes.h"
#include "server/web/web_connections.h"

namespace coopdyn {

/// A recording to download, or the reason why it cannot be.
struct WebRunFile {
  unsigned status = 200;   // of HTTP: 404 no such recording, 409 not now
  std::string text;        // the error; or the list of recordings
  std::string file;        // path
  bool temporary = false;  // to be removed once it is open
};

/// Access to the recordings. Called on the UI thread; each function calls `done` once, on any thread.
struct WebRuns {
  std::function<void(std::function<void(const std::string& json)> done)> list;
  /// `name`: NAME.run or NAME.mat as the client gave it.
  std::function<void(const std::string& name, std::function<void(const WebRunFile&)> done)> open;
};

/// A file sent by the page.
struct WebFile {
  std::string name;  // of the file, as given by the client
  std::string text;
};

/// Access to scenarios, worlds and robots. Called on the UI thread; each function calls `done` once, on any
/// thread.
struct WebFiles {
  using Done = std::function<void(const HttpAnswer&)>;
  std::function<void(WebFile, Done)> check;
  std::function<void(WebFile, Done)> upload;
  std::function<void(Done)> gallery;
  std::function<void(const std::string& kind, const std::string& name, Done)> text;
  std::function<void(const RunView&, Done)> run;
  std::function<void(const std::string& kind, const std::string& name, Done)> thumb;
};

struct WebOptions {
  /// Accepted Host headers, besides IP addresses and "localhost": the names given by `--host` and
  /// `--advertise`, and the machine's own. Any other is refused, as a guard against DNS rebinding.
  std::vector<std::string> host_names;
  /// Judges the token that changing requests from beyond loopback must carry; outlives the server. Null: all
  /// such requests are refused.
  const TokenGuard* guard = nullptr;
  /// The program's version, shown on the page.
  std::string version;
  /// The port of the name server, for the connection lines on the page; 0: off.
  int name_port = 0;
  /// Names of the scenarios, worlds or robots on the search path, sorted. Called on the UI thread.
  std::function<std::vector<std::string>(const std::string& what)> names;
  /// Costs of the run so far. Called on the UI thread. Empty: /api/costs answers 404.
  std::function<CostSnapshot()> costs = {};
  /// Connections beyond these receive 503.
  WebLimits limits = {};
  /// Time limit for a complete request header, including the idle time before it.
  std::chrono::milliseconds header_time{15'000};
  /// Recordings that can be downloaded; without functions: none.
  WebRuns runs = {};
  /// Files that can be browsed, checked and uploaded; without functions: none.
  WebFiles files = {};
};

}  // namespace coopdyn

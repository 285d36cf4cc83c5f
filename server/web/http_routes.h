// SPDX-License-Identifier: MIT
// Routes requests by their first line and headers, and refuses bad ones: all of HTTP that needs no
// connection. Pure; any thread.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/state/image_board.h"
#include "server/web/assets.h"

namespace coopdyn {

struct HttpAnswer {
  unsigned status = 200;
  std::string body = {};  // of an error: one line of text
  std::string type = "text/plain; charset=utf-8";
  std::vector<std::pair<std::string, std::string>> headers = {};
  bool close = false;  // close the connection afterwards
};

/// JSON that must not be cached.
inline HttpAnswer JsonAnswer(const std::string& body) {
  return {.body = body + "\n", .type = "application/json", .headers = {{"Cache-Control", "no-store"}}};
}

/// One line of text that says what is wrong.
inline HttpAnswer ErrorAnswer(unsigned status, const std::string& text) {
  return {.status = status, .body = text + "\n"};
}

/// The header of a request.
struct HttpRequestHead {
  std::string_view method;
  std::string_view target;
  bool http_1_1 = true;
  std::vector<std::string_view> hosts;  // all Host headers
  std::string_view origin;
  std::string_view content_type;
  std::string_view if_none_match;
  bool upgrade = false;  // to a WebSocket
};

enum class HttpRouteKind {
  kRefused,
  kAsset,
  kSnapshot,
  kStream,
  kStatus,
  kNames,
  kModules,
  kScene,
  kText,
  kFileText,
  kMesh,
  kTexture,
  kRuns,
  kRun,
  kRunView,
  kCosts,
  kGallery,
  kThumb,
  kCall,
  kCheck,
  kUpload,
  kSocket
};

/// /runs/NAME.run/WHAT, or /api/playback/WHAT for the recording being played:
/// ?with=OTHER.run&robot=NAME&points=1000&rate=30
struct RunView {
  std::string run;    // empty: the recording being played
  std::string what;   // timeline, scene, poses, table, parting
  std::string with;   // another run
  std::string robot;  // of table; empty: the run itself
  int points = 1000;
  double rate_hz = 30;
};

struct HttpRoute {
  HttpRouteKind kind = HttpRouteKind::kRefused;
  HttpAnswer refusal = {};       // kRefused
  const Asset* asset = nullptr;  // kAsset
  ImageRequest image = {};       // kSnapshot, kStream
  std::string thumb_kind = {};   // kThumb, kFileText: world, scenario or robot
  std::string thumb = {};        // likewise: the name, not yet looked up
  std::string name = {};         // kMesh: 16 hex digits; kTexture
  std::string run = {};          // kRun: NAME.run or NAME.mat, not yet looked up
  RunView view = {};             // kRunView
};

/// The route of `head`. `host_names` as in WebOptions.
HttpRoute FindRoute(const HttpRequestHead& head, const std::vector<std::string>& host_names);

/// Reads the query of `/snapshot.png?w=640&h=480&eye=x,y,z&look=x,y,z&rays=1` into `request`. Returns an
/// error text, empty on success.
std::string ReadImageQuery(std::string_view query, ImageRequest& request);

/// The answer with an asset; 304 if the client has it. The asset is decompressed unless `accept_encoding`
/// contains gzip.
HttpAnswer AnswerAsset(const Asset& asset, std::string_view if_none_match,
                       std::string_view accept_encoding = {});

/// The headers of every answer.
const std::vector<std::pair<std::string, std::string>>& CommonHeaders();
/// The header of an answer that ends with the connection. `more`: further header lines separated by "\r\n",
/// for example the length.
std::string StreamHeader(std::string_view more);

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// What a request line and its headers ask for, and whether that may be: everything about HTTP that needs no
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
  bool close = false;  // the connection, afterwards
};

/// JSON, not to be kept by anybody.
inline HttpAnswer JsonAnswer(const std::string& body) {
  return {.body = body + "\n", .type = "application/json", .headers = {{"Cache-Control", "no-store"}}};
}

/// One line of text that says what is wrong.
inline HttpAnswer ErrorAnswer(unsigned status, const std::string& text) {
  return {.status = status, .body = text + "\n"};
}

/// The request as far as its header goes.
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

/// /runs/NAME.run/WHAT, or /api/playback/WHAT of what is played:
/// ?with=OTHER.run&robot=NAME&points=1000&rate=30
struct RunView {
  std::string run;    // empty: what is played
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
  std::string thumb = {};        // the same: the name, to be looked up among those that there are
  std::string name = {};         // kMesh: 16 hex digits; kTexture
  std::string run = {};          // kRun: NAME.run or NAME.mat, to be checked by whoever keeps them
  RunView view = {};             // kRunView
};

/// Where `head` leads. `host_names`: WebOptions.
HttpRoute FindRoute(const HttpRequestHead& head, const std::vector<std::string>& host_names);

/// Reads the query of `/snapshot.png?w=640&h=480&eye=x,y,z&look=x,y,z&rays=1` into `request`: an error text,
/// empty if it is good.
std::string ReadImageQuery(std::string_view query, ImageRequest& request);

/// The answer with a file; 304 if the client has it.
/// `accept_encoding`: one who does not say gzip gets plain bytes.
HttpAnswer AnswerAsset(const Asset& asset, std::string_view if_none_match,
                       std::string_view accept_encoding = {});

/// The headers that every answer carries.
const std::vector<std::pair<std::string, std::string>>& CommonHeaders();
/// The header of an answer whose end is that of the connection, or that says its length in `more`, lines with
/// "\r\n" between them.
std::string StreamHeader(std::string_view more);

}  // namespace coopdyn

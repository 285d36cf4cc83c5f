// SPDX-License-Identifier: MIT
#include "server/web/http_routes.h"

#include <algorithm>
#include <array>
#include <boost/beast/zlib/inflate_stream.hpp>
#include <cstdint>
#include <optional>
#include <utility>

#include "protocol/ascii.h"
#include "protocol/text_scan.h"
#include "server/base/random.h"
#include "server/naming/run_names.h"
#include "server/web/access.h"

namespace coopdyn {
namespace {

HttpRoute Refuse(unsigned status, const std::string& text) {
  return {.refusal = ErrorAnswer(status, text)};
}

HttpRoute RefuseMethod(std::string allow) {
  HttpRoute route = Refuse(405, "this address accepts only " + allow);
  route.refusal.headers.emplace_back("Allow", std::move(allow));
  return route;
}

std::string ReadPixels(std::string_view key, std::string_view text, int& pixels) {
  std::int32_t value = 0;
  if (ReadInt32(text, value) != NumberRead::kOk) {
    return std::string(key) + " must be a whole number of pixels, e.g. " + std::string(key) + "=640";
  }
  pixels = value;
  return {};
}

std::string ReadPoint(std::string_view key, std::string_view text, std::optional<Vector3>& point) {
  Vector3 read;
  int count = 0;
  std::string_view rest = text;
  for (bool more = true; more; ++count) {
    const auto comma = rest.find(',');
    more = comma != std::string_view::npos;
    double value = 0;
    if (count == 3 || ReadDouble(rest.substr(0, comma), value) != NumberRead::kOk) {
      count = 0;
      break;
    }
    read[count] = value;
    rest.remove_prefix(more ? comma + 1 : rest.size());
  }
  if (count != 3) {
    return std::string(key) + " must be three numbers in metres, e.g. " + std::string(key) + "=-3,0,2";
  }
  point = read;
  return {};
}

std::string ReadFlag(std::string_view key, std::string_view text, bool& flag) {
  if (text != "0" && text != "1") return std::string(key) + " must be 0 or 1";
  flag = text == "1";
  return {};
}

std::string ReadParameter(std::string_view key, std::string_view text, ImageRequest& request) {
  if (key == "w") return ReadPixels(key, text, request.width);
  if (key == "h") return ReadPixels(key, text, request.height);
  if (key == "eye") return ReadPoint(key, text, request.eye_m);
  if (key == "look") return ReadPoint(key, text, request.look_m);
  if (key == "rays") return ReadFlag(key, text, request.show_rays);
  return "unknown parameter " + Quoted(key) + ": write w, h, eye, look or rays";
}

std::string ReadShotParameter(std::string_view key, const std::string& text, CameraShot& shot) {
  if (key == "robot") {
    shot.robot_name = text;
  } else if (key == "camera") {
    shot.module = text;
  } else if (key == "view") {
    constexpr std::array<std::string_view, 3> kViews{"color", "depth", "segmentation"};
    const auto* const found = std::ranges::find(kViews, text);
    if (found == kViews.end()) return "view must be color, depth or segmentation";
    shot.view = static_cast<ShotView>(found - kViews.begin());
  } else {
    return "unknown parameter " + Quoted(key) + ": write robot, camera or view";
  }
  return {};
}

/// Calls take(key, value) for each parameter until a call returns an error. Returns that error, or empty.
template <typename Take>
std::string ReadQuery(std::string_view query, const Take& take) {
  while (!query.empty()) {
    const auto end = query.find('&');
    const std::string_view pair = query.substr(0, end);
    query.remove_prefix(end == std::string_view::npos ? query.size() : end + 1);
    if (pair.empty()) continue;
    const auto equals = pair.find('=');
    std::string coded(equals == std::string_view::npos ? "" : pair.substr(equals + 1));
    std::replace(coded.begin(), coded.end(), '+', ' ');
    const std::optional<std::string> value = PercentDecode(coded);
    if (!value) return "badly escaped: " + Quoted(pair);
    if (std::string error = take(pair.substr(0, equals), *value); !error.empty()) return error;
  }
  return {};
}

/// A picture of a robot's camera.
HttpRoute AcceptShot(HttpRouteKind kind, ImageFormat format, std::string_view query) {
  HttpRoute route{.kind = kind};
  route.image.format = format;
  route.image.paced = kind == HttpRouteKind::kStream;
  route.image.shot.emplace().module = CameraModel::kType;
  CameraShot& shot = *route.image.shot;
  std::string error = ReadQuery(query, [&shot](std::string_view key, const std::string& value) {
    return ReadShotParameter(key, value, shot);
  });
  if (error.empty() && shot.robot_name.empty())
    error = "whose camera? Write ?robot=NAME, and &camera=MODULE unless that is 'camera'";
  return error.empty() ? route : Refuse(400, error);
}

HttpRoute AcceptImage(HttpRouteKind kind, ImageFormat format, std::string_view query) {
  HttpRoute route{.kind = kind};
  route.image.format = format;
  route.image.paced = kind == HttpRouteKind::kStream;
  const std::string error = ReadImageQuery(query, route.image);
  return error.empty() ? route : Refuse(400, error);
}

bool IsJson(std::string_view content_type) {
  constexpr std::string_view kJson = "application/json";
  if (content_type.size() < kJson.size()) return false;
  const bool same = std::equal(kJson.begin(), kJson.end(), content_type.begin(),
                               [](char a, char b) { return a == ToLower(b); });
  const std::string_view rest = content_type.substr(kJson.size());
  return same && (rest.empty() || rest.front() == ';' || IsBlank(rest.front()));
}

constexpr std::string_view kRunFolder = "/runs/";

/// The name of the recording in `path`; empty if `path` names none.
std::string RunNameIn(std::string_view path) {
  if (!path.starts_with(kRunFolder)) return {};
  const std::string name = PercentDecode(path.substr(kRunFolder.size())).value_or("");
  const bool ends_well = name.ends_with(kRunExtension) || name.ends_with(".mat");
  return ends_well && IsRunName(name) ? name : "";
}

/// /runs/NAME.run/WHAT, /api/playback/WHAT; nullopt for any other path.
std::optional<HttpRoute> RunViewIn(std::string_view path, std::string_view query) {
  const auto slash = path.rfind('/');
  if (slash == std::string_view::npos) return std::nullopt;
  RunView view;
  const bool played = path.substr(0, slash) == "/api/playback";
  view.run = RunNameIn(path.substr(0, slash));
  view.what = std::string(path.substr(slash + 1));
  constexpr std::array<std::string_view, 5> kViews = {"timeline", "scene", "poses", "table", "parting"};
  const bool known = std::find(kViews.begin(), kViews.end(), view.what) != kViews.end();
  if (!known || (!played && !view.run.ends_with(kRunExtension))) return std::nullopt;
  std::string error = ReadQuery(query, [&view](std::string_view key, const std::string& value) {
    if (key == "with") {
      view.with = value;
    } else if (key == "robot") {
      view.robot = value;
    } else if (key == "points" || key == "rate") {
      double number = 0;
      const bool fits = ReadDouble(value, number) == NumberRead::kOk && number >= 0.1 && number <= 100'000;
      if (!fits) return std::string(key) + " is a number from 0.1 to 100000, not " + Quoted(value);
      if (key == "rate") view.rate_hz = number;
      if (key == "points") view.points = static_cast<int>(number);
    } else {
      return "unknown parameter " + Quoted(key) + ": write with, robot, points or rate";
    }
    return std::string();
  });
  if (!error.empty()) return Refuse(400, error);
  if (view.what == "parting" && (!view.with.ends_with(kRunExtension) || !IsRunName(view.with))) {
    return Refuse(400, "parting compares two recordings: write ?with=OTHER.run");
  }
  return HttpRoute{.kind = HttpRouteKind::kRunView, .view = std::move(view)};
}

/// The route of a POST to `path`; nullopt if `path` accepts none.
std::optional<HttpRouteKind> PostKind(std::string_view path) {
  if (path == "/api/call") return HttpRouteKind::kCall;
  if (path == "/api/check") return HttpRouteKind::kCheck;
  if (path == "/api/upload") return HttpRouteKind::kUpload;
  return std::nullopt;
}

/// /thumb/KIND/NAME.png; nullopt for any other path.
std::optional<HttpRoute> ThumbIn(std::string_view path) {
  for (const std::string_view kind : {"world", "scenario", "robot"}) {
    const std::string folder = "/thumb/" + std::string(kind) + "/";
    if (!path.starts_with(folder) || !path.ends_with(".png")) continue;
    path.remove_prefix(folder.size());
    path.remove_suffix(std::min<std::size_t>(path.size(), 4));
    std::string name = PercentDecode(path).value_or("");
    if (name.empty()) break;
    return HttpRoute{
        .kind = HttpRouteKind::kThumb, .thumb_kind = std::string(kind), .thumb = std::move(name)};
  }
  return std::nullopt;
}

/// /api/text/KIND/NAME; nullopt for any other path.
std::optional<HttpRoute> FileTextIn(std::string_view path) {
  for (const std::string_view kind : {"world", "scenario"}) {
    const std::string folder = "/api/text/" + std::string(kind) + "/";
    if (!path.starts_with(folder)) continue;
    std::string name = PercentDecode(path.substr(folder.size())).value_or("");
    if (name.empty()) break;
    return HttpRoute{
        .kind = HttpRouteKind::kFileText, .thumb_kind = std::string(kind), .thumb = std::move(name)};
  }
  return std::nullopt;
}

HttpRoute FindGet(std::string_view path, std::string_view query) {
  if (path == "/snapshot.png") return AcceptImage(HttpRouteKind::kSnapshot, ImageFormat::kPng, query);
  if (path == "/view.mjpg") return AcceptImage(HttpRouteKind::kStream, ImageFormat::kJpeg, query);
  if (path == "/camera.png") return AcceptShot(HttpRouteKind::kSnapshot, ImageFormat::kPng, query);
  if (path == "/camera.jpg") return AcceptShot(HttpRouteKind::kSnapshot, ImageFormat::kJpeg, query);
  if (path == "/camera.mjpg") return AcceptShot(HttpRouteKind::kStream, ImageFormat::kJpeg, query);
  if (path == "/api/status") return {.kind = HttpRouteKind::kStatus};
  constexpr std::string_view kApi = "/api/";
  if (path == "/api/scenarios" || path == "/api/worlds" || path == "/api/robots")
    return {.kind = HttpRouteKind::kNames, .name = std::string(path.substr(kApi.size()))};
  if (path == "/api/modules") return {.kind = HttpRouteKind::kModules};
  if (path == "/api/costs") return {.kind = HttpRouteKind::kCosts};
  if (path == "/api/gallery") return {.kind = HttpRouteKind::kGallery};
  if (std::optional<HttpRoute> thumb = ThumbIn(path)) return *std::move(thumb);
  if (path == "/api/text") return {.kind = HttpRouteKind::kText};
  if (std::optional<HttpRoute> text = FileTextIn(path)) return *std::move(text);
  if (path == "/api/scene") return {.kind = HttpRouteKind::kScene};
  constexpr std::string_view kMeshes = "/api/mesh/", kGlb = ".glb", kTextures = "/api/texture/";
  if (path.starts_with(kMeshes) && path.ends_with(kGlb) && path.size() == kMeshes.size() + 16 + kGlb.size()) {
    return {.kind = HttpRouteKind::kMesh, .name = std::string(path.substr(kMeshes.size(), 16))};
  }
  if (path.starts_with(kTextures)) {
    const std::optional<std::string> name = PercentDecode(path.substr(kTextures.size()));
    return name ? HttpRoute{.kind = HttpRouteKind::kTexture, .name = *name} : Refuse(400, "badly escaped");
  }
  if (path == "/runs") return {.kind = HttpRouteKind::kRuns};
  if (std::string name = RunNameIn(path); !name.empty()) {
    return {.kind = HttpRouteKind::kRun, .run = std::move(name)};
  }
  if (std::optional<HttpRoute> view = RunViewIn(path, query)) return *std::move(view);
  if (const Asset* asset = FindAsset(path)) {
    return {.kind = HttpRouteKind::kAsset, .asset = asset};
  }
  return Refuse(404, "there is nothing here: the page is at /");
}

std::string RefuseHost(const HttpRequestHead& head, const std::vector<std::string>& host_names,
                       unsigned& status) {
  status = 400;
  if (head.hosts.size() > 1) return "more than one Host header";
  if (head.hosts.empty()) return head.http_1_1 ? "HTTP/1.1 needs a Host header" : "";
  const auto name = HostName(head.hosts.front());
  if (!name) return "the Host header is not a host name";
  status = 403;
  if (HostAllowed(head.hosts.front(), host_names)) return {};
  return "this daemon does not go by the name " + *name +
         ": use its IP address, or start it with --advertise " + *name;
}

}  // namespace

std::string ReadImageQuery(std::string_view query, ImageRequest& request) {
  std::string error = ReadQuery(query, [&request](std::string_view key, const std::string& value) {
    return ReadParameter(key, value, request);
  });
  return error.empty() ? CheckImageRequest(request) : error;
}

HttpRoute FindRoute(const HttpRequestHead& head, const std::vector<std::string>& host_names) {
  unsigned status = 0;
  if (std::string error = RefuseHost(head, host_names, status); !error.empty()) {
    return Refuse(status, error);
  }
  if (!head.target.starts_with('/')) return Refuse(400, "the address must start with /");
  const auto mark = head.target.find('?');
  const std::string_view path = head.target.substr(0, mark);
  const std::string_view query = mark == std::string_view::npos ? "" : head.target.substr(mark + 1);

  const bool from_here =
      head.origin.empty() || (!head.hosts.empty() && OriginAllowed(head.origin, head.hosts.front()));
  constexpr const char* kForeign = "pages of other hosts may not drive robots: open the daemon's own page";
  if (path == "/ws") {
    if (head.method != "GET") return RefuseMethod("GET");
    if (!head.upgrade) {
      HttpRoute route = Refuse(426, "this address speaks WebSocket");
      route.refusal.headers.emplace_back("Upgrade", "websocket");
      return route;
    }
    return from_here ? HttpRoute{.kind = HttpRouteKind::kSocket} : Refuse(403, kForeign);
  }
  if (const std::optional<HttpRouteKind> posted = PostKind(path)) {
    if (head.method != "POST") return RefuseMethod("POST");
    if (!from_here) return Refuse(403, kForeign);
    if (!IsJson(head.content_type)) return Refuse(415, "send JSON, with Content-Type: application/json");
    return {.kind = *posted};
  }
  HttpRoute route = FindGet(path, query);
  const bool found = route.kind != HttpRouteKind::kRefused || route.refusal.status != 404;
  if (found && head.method != "GET" && head.method != "HEAD") return RefuseMethod("GET, HEAD");
  return route;
}

std::string StreamHeader(std::string_view more) {
  std::string header = "HTTP/1.1 200 OK\r\nConnection: close\r\nCache-Control: no-store\r\n";
  for (const auto& [name, value] : CommonHeaders()) header += name + ": " + value + "\r\n";
  return header.append(more) + "\r\n\r\n";
}

std::string PlainBytes(const Asset& asset) {
  constexpr std::size_t kHead = 10, kTail = 8;  // bytes of gzip's header (without a file name) and trailer
  if (!asset.compressed || asset.bytes.size() < kHead + kTail) return std::string(asset.bytes);
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    size |= std::uint32_t{static_cast<unsigned char>(asset.bytes[asset.bytes.size() - 4 + i])} << (8 * i);
  }
  std::string plain(size, '\0');
  boost::beast::zlib::z_params params;
  params.next_in = asset.bytes.data() + kHead;
  params.avail_in = asset.bytes.size() - kHead - kTail;
  params.next_out = plain.data();
  params.avail_out = plain.size();
  boost::beast::zlib::inflate_stream inflate;
  boost::system::error_code ended;
  inflate.write(params, boost::beast::zlib::Flush::sync, ended);
  plain.resize(plain.size() - params.avail_out);
  return plain;
}

HttpAnswer AnswerAsset(const Asset& asset, std::string_view if_none_match, std::string_view accept_encoding) {
  HttpAnswer answer;
  const std::string tag = EntityTag(asset);
  answer.type = ContentType(asset.path);
  answer.headers = {{"ETag", tag}, {"Cache-Control", "no-cache"}};
  if (asset.path.ends_with(".zip") || asset.path.ends_with(".py")) {
    answer.headers.emplace_back("Content-Disposition",
                                "attachment; filename=\"" + std::string(asset.path.substr(1)) + "\"");
  }
  if (if_none_match == "*" || if_none_match.find(tag) != std::string_view::npos) {
    answer.status = 304;
  } else if (asset.compressed && accept_encoding.find("gzip") != std::string_view::npos) {
    answer.headers.emplace_back("Content-Encoding", "gzip");
    answer.body = asset.bytes;
  } else {
    answer.body = PlainBytes(asset);
  }
  if (asset.compressed) answer.headers.emplace_back("Vary", "Accept-Encoding");
  return answer;
}

const std::vector<std::pair<std::string, std::string>>& CommonHeaders() {
  static const std::vector<std::pair<std::string, std::string>> kHeaders = {
      {"Server", "coopdyn"},
      {"Content-Security-Policy", "default-src 'self'; frame-ancestors 'none'"},
      {"X-Content-Type-Options", "nosniff"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Referrer-Policy", "no-referrer"}};
  return kHeaders;
}

const Asset* FindAsset(std::string_view path) {
  if (path == "/") path = "/index.html";
  for (const Asset& asset : Assets()) {
    if (asset.path == path) return &asset;
  }
  return nullptr;
}

std::string_view ContentType(std::string_view path) {
  using Pair = std::pair<std::string_view, std::string_view>;
  constexpr std::array<Pair, 7> kTypes = {{{".html", "text/html; charset=utf-8"},
                                           {".js", "text/javascript; charset=utf-8"},
                                           {".css", "text/css; charset=utf-8"},
                                           {".svg", "image/svg+xml"},
                                           {".png", "image/png"},
                                           {".py", "text/x-python; charset=utf-8"},
                                           {".zip", "application/zip"}}};
  for (const auto& [ending, type] : kTypes) {
    if (path.ends_with(ending)) return type;
  }
  return "application/octet-stream";
}

std::string EntityTag(const Asset& asset) {
  const std::uint64_t hash = HashOfBytes(asset.bytes);
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string tag = "\"";
  for (int shift = 60; shift >= 0; shift -= 4) tag += kDigits[(hash >> shift) & 15U];
  return tag + "\"";
}

}  // namespace coopdyn

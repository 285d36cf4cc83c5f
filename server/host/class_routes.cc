// SPDX-License-Identifier: MIT
#include "server/host/class_routes.h"

#include <algorithm>

#include "server/base/words.h"

namespace coopdyn {
namespace {

/// NAME and the rest of NAME/rest; without a slash the rest is empty.
ClassRoute SeatRoute(std::string_view path, ClassRouteKind kind) {
  const std::size_t slash = path.find('/');
  ClassRoute route{.kind = kind, .seat = std::string(path.substr(0, slash))};
  if (slash != std::string_view::npos) route.rest = path.substr(slash);
  return route;
}

}  // namespace

ClassRoute FindClassRoute(std::string_view target) {
  const std::string_view path = target.substr(0, target.find('?'));
  if (path == "/" || path == "/wall/")
    return {ClassRouteKind::kAsset, {}, path == "/" ? "/login.html" : "/wall.html"};
  if (path == "/login") return {ClassRouteKind::kLogin};
  if (path == "/wall/login") return {ClassRouteKind::kWallLogin};
  if (path.starts_with("/l/")) return {ClassRouteKind::kLink, {}, std::string(path.substr(3))};
  constexpr std::string_view kClass = "/class/";
  if (target.starts_with("/s/")) {
    ClassRoute route = SeatRoute(target.substr(3), ClassRouteKind::kSeat);
    if (!route.rest.starts_with(kClass)) return route;
    route.kind = ClassRouteKind::kSeatAsks;
    route.rest = route.rest.substr(kClass.size(), route.rest.find('?') - kClass.size());
    if (route.rest != "program" && !route.rest.starts_with("program/")) return route;
    return {ClassRouteKind::kProgram, route.seat,
            route.rest.substr(std::min<std::size_t>(8, route.rest.size()))};
  }
  if (target.starts_with("/wall/s/")) return SeatRoute(target.substr(8), ClassRouteKind::kWallSeat);
  constexpr std::string_view kPrograms = "/wall/class/programs/";
  if (path.starts_with(kPrograms)) {
    ClassRoute route = SeatRoute(path.substr(kPrograms.size()), ClassRouteKind::kWallProgram);
    if (!route.rest.empty()) route.rest.erase(0, 1);
    return route;
  }
  if (path.starts_with("/wall/class/"))
    return {ClassRouteKind::kWallAsks, {}, std::string(path.substr(std::string_view("/wall/class/").size()))};
  if (path.starts_with("/wall/")) return {ClassRouteKind::kAsset, {}, std::string(path.substr(5))};
  return {ClassRouteKind::kAsset, {}, std::string(path)};
}

std::string_view CookieIn(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    const std::size_t end = header.find(';');
    const std::string_view pair = Trim(header.substr(0, end));
    header.remove_prefix(end == std::string_view::npos ? header.size() : end + 1);
    const std::size_t equals = pair.find('=');
    if (equals != std::string_view::npos && pair.substr(0, equals) == name) return pair.substr(equals + 1);
  }
  return {};
}

}  // namespace coopdyn

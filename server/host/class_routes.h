// SPDX-License-Identifier: MIT
// Where a request to the pages of a class leads. Pure; any thread.
#pragma once

#include <string>
#include <string_view>

namespace coopdyn {

enum class ClassRouteKind {
  kUnknown,
  kAsset,       // /, /wall and the files of both
  kLink,        // /l/LINK: a student's personal link
  kLogin,       // POST /login
  kWallLogin,   // POST /wall/login
  kSeatAsks,    // /s/NAME/class/WHAT
  kSeat,        // /s/NAME/...: of the seat's daemon
  kWallAsks,    // /wall/class/WHAT
  kWallSeat,    // /wall/s/NAME/...: the teacher at a seat
  kProgram,     // /s/NAME/class/program/WHAT; WHAT may be empty
  kWallProgram  // /wall/class/programs/NAME/WHAT
};

struct ClassRoute {
  ClassRouteKind kind = ClassRouteKind::kUnknown;
  std::string seat = {};  // NAME
  std::string rest = {};  // WHAT, LINK, the file, or the target for the seat's daemon, from its '/' on
};

/// `target` of the request line.
ClassRoute FindClassRoute(std::string_view target);

/// The value of the cookie `name` in a Cookie header; empty: it is not there.
std::string_view CookieIn(std::string_view header, std::string_view name);

}  // namespace coopdyn

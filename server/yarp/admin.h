// SPDX-License-Identifier: MIT
// The answers of a YARP port about itself. Pure functions; any thread.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/yarp/bottle.h"
#include "server/yarp/links.h"

namespace coopdyn {

/// A port as seen from one of its connections.
struct YarpPortView {
  std::string_view path;            // "/robot1/motors"
  std::string_view peer;            // the peer's name for itself
  std::string_view carrier;         // "tcp"
  std::span<const YarpLink> links;  // outgoing connections of the port
};

/// `[add] "tcp://reader"` or `[del] "/reader"`, which change connections.
struct YarpLinkChange {
  bool adds = false;
  std::string to;  // "tcp://reader"; for a deletion "/reader"
};
/// Nullopt if it is another request.
std::optional<YarpLinkChange> LinkChangeIn(const Bottle& request);
/// The same for a line of text: "/reader", "!/reader", "~/reader".
std::optional<YarpLinkChange> LinkChangeIn(std::string_view line);
/// The reply's Bottle, whose first value clients compare with 0.
Bottle LinkReply(bool done, const std::string& text);

/// The reply to any other administrative Bottle (`[ver]`, `[list] [in]`, …).
Bottle AnswerYarpAdmin(const Bottle& request, const YarpPortView& port);
/// The lines of `*`, each with its end.
std::string DescribeYarpPort(const YarpPortView& port);
/// The lines of `?`.
std::string YarpHelp();

}  // namespace coopdyn

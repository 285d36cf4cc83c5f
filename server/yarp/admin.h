// SPDX-License-Identifier: MIT
// What a port of YARP answers about itself. Pure functions; any thread.
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
  std::string_view peer;            // what the other side calls itself
  std::string_view carrier;         // "tcp"
  std::span<const YarpLink> links;  // that it has opened
};

/// `[add] "tcp://reader"` or `[del] "/reader"`, which change connections.
struct YarpLinkChange {
  bool adds = false;
  std::string to;  // "tcp://reader", or to delete "/reader"
};
/// Nothing: it is another request.
std::optional<YarpLinkChange> LinkChangeIn(const Bottle& request);
/// The same as a line of text: "/reader", "!/reader", "~/reader".
std::optional<YarpLinkChange> LinkChangeIn(std::string_view line);
/// The Bottle of the reply, which clients test for 0.
Bottle LinkReply(bool done, const std::string& text);

/// The reply to an administrative Bottle (`[ver]`, `[list] [in]`, …), but LinkChangeIn().
Bottle AnswerYarpAdmin(const Bottle& request, const YarpPortView& port);
/// The lines of `*`, each with its end.
std::string DescribeYarpPort(const YarpPortView& port);
/// The lines of `?`.
std::string YarpHelp();

}  // namespace coopdyn

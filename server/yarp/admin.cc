// SPDX-License-Identifier: MIT
#include "server/yarp/admin.h"

#include <unistd.h>

#include "server/naming/name_protocol.h"

namespace coopdyn {
namespace {

Bottle Pair(std::string key, auto value) {
  return BottleOf(std::move(key), std::move(value));
}

Bottle DescribeLink(std::string_view from, std::string_view to, std::string_view carrier) {
  return BottleOf(Pair("from", std::string(from)), Pair("to", std::string(to)),
                  Pair("carrier", std::string(carrier)));
}

/// Lists all connections of one direction, or describes the one that the request names.
Bottle List(const Bottle& request, const YarpPortView& port) {
  const bool named = request.size() > 2;
  const std::string_view name = WordAt(request, 2);
  Bottle list;
  if (WordAt(request, 1) == "in") {
    if (!port.peer.starts_with('/')) return {};
    if (named) return name == port.peer ? DescribeLink(port.peer, port.path, port.carrier) : Bottle();
    list.emplace_back(std::string(port.peer));
    return list;
  }
  for (const YarpLink& link : port.links) {
    if (named && name == link.other) return DescribeLink(port.path, link.other, link.carrier);
    if (!named) list.emplace_back(link.other);
  }
  return list;
}

Bottle Property(const Bottle& request) {
  if (WordAt(request, 1) == "set")
    return BottleOf(YarpVocab{"fail"}, std::string("a port of the daemon has no properties to be set"));
  if (WordAt(request, 1) != "get") return {};
  const Bottle process = BottleOf(Pair("name", std::string("coopdyn")), Pair("pid", std::int32_t{getpid()}));
  const Bottle platform = BottleOf(Pair("os", std::string("Linux")));
  const Bottle about = BottleOf(Pair("is_input", std::int32_t{1}), Pair("is_output", std::int32_t{1}),
                                Pair("is_rpc", std::int32_t{1}), Pair("type", std::string()));
  return BottleOf(Pair("process", process), Pair("platform", platform), Pair("port", about));
}

}  // namespace

std::optional<YarpLinkChange> LinkChangeIn(const Bottle& request) {
  const std::string_view verb = WordAt(request, 0), other = WordAt(request, 1);
  if (other.empty() || (verb != "add" && verb != "del")) return {};
  if (verb == "del") return YarpLinkChange{false, NameInAddress(other)};
  const std::string_view carrier = WordAt(request, 2);  // `[add] "/reader" tcp`
  const bool told = other.find(":/") != std::string_view::npos;
  return YarpLinkChange{
      true, told || carrier.empty() ? std::string(other) : std::string(carrier) + ":/" + std::string(other)};
}

std::optional<YarpLinkChange> LinkChangeIn(std::string_view line) {
  if (line.starts_with('/')) return YarpLinkChange{true, std::string(line)};
  if (line.starts_with("!/") || line.starts_with("~/"))
    return YarpLinkChange{false, std::string(line.substr(1))};
  return {};
}

Bottle LinkReply(bool done, const std::string& text) {
  return BottleOf(std::int32_t{done ? 0 : -1}, text);
}

Bottle AnswerYarpAdmin(const Bottle& request, const YarpPortView& port) {
  const std::string_view verb = WordAt(request, 0);
  const std::string_view in_or_out = WordAt(request, 1);
  if (verb == "ver") return BottleOf(YarpVocab{"ver"}, std::int32_t{1}, std::int32_t{2}, std::int32_t{3});
  if (verb == "list" && (in_or_out == "in" || in_or_out == "out")) return List(request, port);
  if (verb == "prop") return Property(request);
  if (verb == "help") {
    return BottleOf(YarpVocab{"many"}, std::string("[ver]: the version of this protocol"),
                    std::string("[list] [in]: who is connected"),
                    std::string("[list] [out]: to whom this port sends"),
                    std::string("[add] $portname: send to that port; [del] $portname: no longer"),
                    std::string("[prop] [get] $portname: what this port is"));
  }
  return BottleOf(YarpVocab{"fail"}, std::string("send [help] for list of valid commands"));
}

std::string DescribeYarpPort(const YarpPortView& port) {
  const auto connection = [](std::string kind, std::string_view from, std::string_view to,
                             std::string_view carrier) {
    return "There is an " + std::move(kind) + " connection from " + std::string(from) + " to " +
           std::string(to) + " using " + std::string(carrier) + "\r\n";
  };
  std::string text = "This is " + std::string(port.path) + "\r\n";
  if (port.links.empty()) text += "There are no outgoing connections\r\n";
  for (const YarpLink& link : port.links) text += connection("output", port.path, link.other, link.carrier);
  return text + connection("input", port.peer, port.path, port.carrier);
}

std::string YarpHelp() {
  return "This is a port of YARP. Its commands, each on a line of its own:\r\n"
         "  d    then a request on the next line, as in get_status: the reply follows\r\n"
         "  D    then a request on the next line: no reply\r\n"
         "  r    readings come from now on\r\n"
         "  a    then an administrative command on the next line, as in [help]\r\n"
         "  /x   readings go to the port /x from now on; !/x: no longer\r\n"
         "  *    who is connected\r\n"
         "  q    the end\r\n";
}

}  // namespace coopdyn

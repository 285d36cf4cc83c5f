// SPDX-License-Identifier: MIT
// What a session reads: requests that are answered at once.
#include <algorithm>
#include <set>
#include <utility>

#include "clients/cpp/codes.h"
#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

constexpr std::int32_t kStatusRobots = 1000;  // robots in one status

}  // namespace

Message Session::Control(std::int32_t command, std::vector<std::int32_t> params, std::vector<double> data,
                         std::string text, double timeout_s) {
  RequireOpen();
  if (!simulation_.Alive()) simulation_.Open();
  Message reply = simulation_.Request(command, std::move(params), data, std::move(text), timeout_s);
  for (const auto& link : links_) link->carried.reset();
  return Note(reply);
}

Message Session::Tell(const std::string& module, std::int32_t command, std::vector<std::int32_t> params,
                      std::vector<double> data, std::string text, double timeout_s) {
  RequireOpen();
  std::unique_ptr<Connection>& connection = others_[module];
  if (!connection) connection = std::make_unique<Connection>(address_, module, !watch_);
  if (!connection->Alive()) connection->Open();
  Message reply = connection->Request(command, std::move(params), data, std::move(text), timeout_s);
  for (const auto& link : links_) link->carried.reset();
  return Note(reply);
}

Json Session::Status() {
  return Json::Parse(Control(command::kGetStatus).text);
}

std::vector<std::string> Session::RobotNames() {
  std::vector<std::string> names;
  while (true) {  // one status lists only a part of them
    const auto first = static_cast<std::int32_t>(names.size() + 1);
    const Json status = Json::Parse(Control(command::kGetStatus, {first, kStatusRobots}).text);
    for (const Json& robot : status["robots"].items()) names.push_back(robot["name"].text());
    if (status["robots"].size() == 0 || static_cast<double>(names.size()) >= status["robot_count"].number())
      return names;
  }
}

Message Session::Read(Link& link, const std::string& module, std::int32_t command,
                      std::vector<std::int32_t> params, std::string text, std::vector<double> data) {
  RequireOpen();
  if (link.lost && link.lost->code() == kNoSuchName) throw Error(*link.lost);
  if (module == "motors" && link.motors && !link.lost) {
    Settle(link);
    const std::int64_t since = reached_;
    try {
      return Fresh(
          link.motors->Request(command, std::move(params), {}, std::move(text), kRequestTimeout_s, spin_s()),
          since);
    } catch (const Closed& e) {
      Lose(link, e);
    }
  }
  std::unique_ptr<Connection>& reader = link.readers[module];
  // What a robot sends is its driver's to say: that connection has the driver's name.
  const bool sends = module == "neighbours" && !watch_;
  if (!reader) reader = std::make_unique<Connection>(address_, "/" + link.robot + "/" + module, sends);
  try {
    return Fresh(Ask(*reader, command, std::move(params), std::move(text), std::move(data)), reached_);
  } catch (const Error& e) {
    if (e.code() != kNoSuchName || reader->is_open()) throw;
    const std::vector<std::string> names = RobotNames();
    if (std::find(names.begin(), names.end(), link.robot) == names.end()) throw NewWorld(kLoad);
    if (module != "neighbours") throw;
    throw Error(kNotPossible, link.robot + " has no module neighbours, its type has none: a robot of type " +
                                  "minibot has one, or add it to the robot's model.sdf (docs/formats.md)");
  }
}

Message Session::Ask(Connection& connection, std::int32_t command, std::vector<std::int32_t> params,
                     std::string text, std::vector<double> data) {
  if (connection.is_open() && !connection.busy()) {
    try {
      return Note(connection.Request(command, params, data, text, kRequestTimeout_s, spin_s()));
    } catch (const Closed&) {
    }
  }
  connection.Open();
  return Note(connection.Request(command, std::move(params), data, std::move(text), kRequestTimeout_s));
}

Json Session::Describe(const std::string& module) {
  RequireOpen();
  Connection connection(address_, module, false);
  return Json::Parse(Ask(connection, command::kDescribe, {}, "").text);
}

void Session::Attach(Link& link) {
  std::set<std::string> names;
  for (const Module& module : address_.Modules()) names.insert(module.name);
  std::vector<std::string> readable;
  for (const char* module : {"motors", "distance", "target", "pose"}) {
    if (names.contains("/" + link.robot + "/" + module)) readable.emplace_back(module);
  }
  if (readable.empty()) throw Error(kNoSuchName, link.robot + " has no readings");
  AttachedConnection(link, readable).Request(command::kAttach, {}, {}, Join(readable, " "));
  link.attached = std::move(readable);
}

Connection& Session::AttachedConnection(Link& link, const std::vector<std::string>& modules) {
  if (link.motors) {
    Settle(link);
    return *link.motors;
  }
  std::unique_ptr<Connection>& reader = link.readers["attached"];
  if (!reader) reader = std::make_unique<Connection>(address_, "/" + link.robot + "/" + modules[0], false);
  if (!reader->Alive()) {
    reader->Open();
    if (!link.attached.empty()) reader->Request(command::kAttach, {}, {}, Join(link.attached, " "));
  }
  return *reader;
}

Message Session::Sense(Link& link) {
  RequireOpen();
  if (link.lost && link.lost->code() == kNoSuchName) throw Error(*link.lost);
  if (link.attached.empty()) Attach(link);
  if (link.carried) return std::move(*std::exchange(link.carried, std::nullopt));
  Connection& connection = AttachedConnection(link, link.attached);
  const std::int64_t since = reached_;
  try {
    return Fresh(connection.Request(command::kGetTime, {}, {}, "", kRequestTimeout_s, spin_s()), since);
  } catch (const Closed& e) {
    if (!link.motors && !e.by_load()) throw;
    Lose(link, e);
  }
}

}  // namespace coopdyn::client

// SPDX-License-Identifier: MIT
// A team as this client drives it. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clients/cpp/connection.h"
#include "clients/cpp/error.h"
#include "protocol/message.h"

namespace coopdyn::client {

/// One connection to /swarm, which owns all robots of the team.
struct TeamLink {
  std::string text;  // the names as they were asked for
  int number = 1;    // tells the teams of one client apart
  std::unique_ptr<Connection> connection;
  std::string selected = "pose distances";
  int neighbours = 8;
  std::vector<std::string> names;
  std::vector<std::int32_t> ids;
  std::vector<std::string> readings;  // in the order of a row
  std::vector<std::int32_t> columns;  // of each
  bool stale = false;                 // who is in it must be asked anew
  std::optional<Message> reply;       // to the step that ran last
  std::vector<std::string> gone;      // who was taken from it since it stepped last
  std::optional<Error> lost;          // why it is not ours any more
  std::string playing;  // why nobody can have the robots: a recording is played; then it is for reading
  /// Numbers that were handed out; whose readers are gone is used again.
  std::array<std::shared_ptr<std::vector<double>>, 2> handed_out;

  /// In errors.
  std::string label() const { return one_word() ? "team " + text : "team of " + Count(names.size()); }
  std::string TakeAgain() const {
    return text.empty() ? "sim.team()" : one_word() ? "sim.team(\"" + text + "\")" : "sim.team({...})";
  }
  bool one_word() const { return !text.empty() && text.find(' ') == std::string::npos; }
  static std::string Count(std::size_t n) { return std::to_string(n) + " robots"; }
};

/// What one team of a session does in a step, while the others keep their speeds.
struct TeamCommand {
  TeamLink* team = nullptr;
  std::string text;  // `wheels`, or empty
  std::span<const double> values;
};

}  // namespace coopdyn::client

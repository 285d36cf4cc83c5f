// SPDX-License-Identifier: MIT
// A team as a session drives it. One thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "clients/cpp/connection.h"
#include "clients/cpp/error.h"
#include "protocol/message.h"

namespace coopdyn::client {

class Session;

/// One connection to /swarm, which owns all robots of the team. While a recording is played nobody can have
/// the robots, so the team reads.
struct TeamLink {
  /// `text`: the names as they were asked for. `number` tells the teams of one client apart.
  TeamLink(Session& session_of, std::string text_of, int number_of);

  /// Opens and claims. Throws Error 6 if a robot is owned by another.
  void Open();
  /// Waits until the connection is free for a request; asks who is in the team if that may have changed.
  void Settle();
  /// Throws Error 5 while a recording is played; a branch may have gone on live from there.
  void Own();
  /// Chooses the readings.
  void Select(const std::string& words, int nearest);
  /// A request that is answered at once.
  Message Ask(std::int32_t command, std::vector<std::int32_t> params = {});
  /// The readings of the newest step.
  Message Read();
  /// What of a row changes if robots or targets have come or gone; asked anew.
  void Refresh();
  /// Gives the robots up, after stopping them if wished.
  void GiveUp(bool stop);
  /// The daemon closed the connection.
  [[noreturn]] void Lose(const Closed& closed);
  /// Throws who owns the robot that `owned` names.
  [[noreturn]] void NotOurs(const Error& owned) const;
  bool Has(const std::string& robot) const;

  /// In errors.
  std::string label() const;
  std::string TakeAgain() const;

  Session& session;
  const std::string text;
  const int number;
  Connection connection;
  std::string selected = "pose distances";
  int neighbours = 8;
  std::vector<std::string> names;
  std::vector<std::int32_t> ids;      // as many
  std::vector<std::string> readings;  // in the order of a row
  std::vector<std::size_t> columns;   // of each
  bool stale = false;                 // who is in it must be asked anew
  std::optional<Message> reply;       // to the step that ran last
  std::vector<std::string> gone;      // who was taken from it since it stepped last
  std::optional<Error> lost;          // why it is not ours any more
  std::string playing;  // why nobody can have the robots: a recording is played; then it is for reading

 private:
  bool one_word() const { return !text.empty() && text.find(' ') == std::string::npos; }
  Message Claim();
  /// Takes over who is in the team. One that has lost all its robots is none any more: throws.
  void Name(Message reply);
  /// Makes the robots ours; while a recording is played only finds out which they are.
  void Take();
  /// Who is meant, in a recording that is played: `claim` has found the names good, but tells no ids.
  void Find();
  /// The ids of the n robots, in their order: from 1 on, with gaps where robots have been removed.
  std::vector<std::int32_t> KnownIds(std::size_t n);
};

/// What one team of a session does in a step, while the others keep their speeds.
struct TeamCommand {
  TeamLink* team = nullptr;
  std::string text;  // `wheels`, or empty
  std::span<const double> values;
};

}  // namespace coopdyn::client

// SPDX-License-Identifier: MIT
// The teams of a session: one connection to /swarm each.
#include <algorithm>
#include <chrono>
#include <utility>

#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

constexpr int kNotPossible = 5, kOwned = 6, kNoSuchName = 10;
constexpr double kRequestTimeout_s = 10;

void Name(TeamLink& team, Message reply) {
  team.names = Words(reply.text);
  team.ids = std::move(reply.params);
  team.stale = false;
}

Message Claim(TeamLink& team) {
  Connection& connection = *team.connection;
  if (!team.text.empty() || team.names.empty()) return connection.Request(command::kClaim, {}, {}, team.text);
  try {  // again all that were free, not what is free by now
    return connection.Request(command::kClaim, {}, {}, Join(team.names, " "));
  } catch (const Error& e) {
    if (e.code() != kNoSuchName) throw;
  }
  return connection.Request(command::kClaim);
}

}  // namespace

std::shared_ptr<TeamLink> Session::DriveTeam(const std::string& text) {
  RequireOpen();
  if (watch_) throw Error(kNotPossible, "this sim only watches; connect without watch to drive a team");
  std::erase_if(teams_, [](const auto& team) { return team->lost.has_value(); });
  auto team = std::make_shared<TeamLink>();
  for (const auto& other : teams_) {
    if (other->text == text) return other;
  }
  while (std::any_of(teams_.begin(), teams_.end(), [&](const auto& t) { return t->number == team->number; }))
    ++team->number;
  team->text = text;
  team->connection = std::make_unique<Connection>(address_, "/swarm", team->number);
  try {
    OpenTeam(*team);
  } catch (const Error& e) {
    if (e.code() != kOwned) throw;
    throw Error(kOwned, team->label() + " cannot be driven: " + e.what() +
                            ". Stop the other program, or free the robot on the page");
  }
  if (team->names.empty()) throw Error(kNoSuchName, "there is no robot that nobody drives");
  teams_.push_back(team);
  return team;
}

void Session::OpenTeam(TeamLink& team) {
  Connection& connection = *team.connection;
  connection.Open();
  try {
    if (team.names.empty()) connection.Request(command::kRelease);  // an older team may have been of others
    Name(team, Claim(team));
    Select(team, team.selected, team.neighbours);
    Note(connection.Request(command::kGetTime));
  } catch (...) {
    connection.Close();
    throw;
  }
}

Connection& Session::SettleTeam(TeamLink& team) {
  RequireOpen();
  if (team.lost) throw Error(*team.lost);
  if (!team.connection->is_open() || team.connection->busy()) OpenTeam(team);
  if (team.stale) Name(team, team.connection->Request(command::kGetTeam));
  return *team.connection;
}

void Session::Select(TeamLink& team, const std::string& words, int neighbours) {
  std::vector<std::int32_t> params;
  if (words.find("neighbours") != std::string::npos) params.push_back(neighbours);
  Message reply = team.connection->Request(command::kSelectReadings, params, {}, words);
  team.selected = words;
  team.neighbours = neighbours;
  team.readings = Words(reply.text);
  team.columns = std::move(reply.params);
  team.columns.resize(team.readings.size());
}

Message Session::AskTeam(TeamLink& team, std::int32_t command) {
  Connection& connection = SettleTeam(team);
  try {
    Message reply = connection.Request(command, {}, {}, "", kRequestTimeout_s, spin_s());
    Note(reply);
    return reply;
  } catch (const Closed& e) {
    throw Lost(e, team.label(), team.TakeAgain(), team.lost);
  }
}

void Session::RefreshTeam(TeamLink& team) {
  Name(team, AskTeam(team, command::kGetTeam));
  Select(team, team.selected, team.neighbours);
}

Message Session::StepTeam(const TeamCommand& command, double timeout_s) {
  TeamLink& team = *command.team;
  for (std::shared_ptr<std::vector<double>>& values : team.handed_out) {
    if (values.use_count() != 1) continue;
    team.connection->Recycle(std::move(*values));
    values.reset();
    break;
  }
  Step(1, timeout_s, command);
  return std::move(*std::exchange(team.reply, std::nullopt));
}

void Session::CloseTeam(TeamLink& team, bool stop) {
  Connection& connection = *team.connection;
  if (connection.is_open() && !team.lost) {
    try {
      if (stop) connection.Send(command::kStopTeam, {}, {});
      connection.Send(command::kRelease, {}, {});
      connection.FinishSending();
      connection.AwaitEnd(std::chrono::steady_clock::now() + std::chrono::milliseconds(200));
    } catch (const Error&) {
      // It is gone already.
    }
  }
  connection.Close();
  if (!team.lost)
    team.lost.emplace(kNotPossible, team.label() + " was given up; " + team.TakeAgain() + " takes it again");
  std::erase_if(teams_, [&](const auto& other) { return other.get() == &team; });
}

void Session::Send(Link& link, const std::vector<double>& values) {
  if (watch_) throw Error(kNotPossible, "this sim only watches; connect without watch to drive");
  Read(link, "neighbours", command::kSendMessage, {}, "", values);
}

}  // namespace coopdyn::client

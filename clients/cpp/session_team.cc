// SPDX-License-Identifier: MIT
// The teams of a session: one connection to /swarm each.
#include <algorithm>
#include <chrono>
#include <iterator>
#include <set>
#include <utility>

#include "clients/cpp/codes.h"
#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

std::string FirstWord(const std::string& text) {
  return text.substr(0, text.find(' '));
}

}  // namespace

void Session::NameTeam(TeamLink& team, Message reply) {
  const std::vector<std::string> before = std::exchange(team.names, Words(reply.text));
  team.ids = std::move(reply.params);
  team.stale = false;
  if (team.names.size() < before.size()) {
    const std::set<std::string> left(team.names.begin(), team.names.end());
    std::copy_if(before.begin(), before.end(), std::back_inserter(team.gone),
                 [&](const std::string& name) { return !left.contains(name); });
  }
  if (before.empty() || !team.names.empty()) return;
  team.connection->Close();
  const std::string what = team.one_word() ? team.label() : "the team of " + TeamLink::Count(before.size());
  team.lost.emplace(kNotPossible, what + " has lost all its robots, to other programs or another scenario: " +
                                      team.TakeAgain() + " takes whom it means now");
  ThrowIfLoaded(*team.lost);
  throw Error(*team.lost);
}

/// Again those that it had, not whom its name would mean by now: less who is another's meanwhile.
Message Session::Claim(const TeamLink& team) {
  Connection& connection = *team.connection;
  std::set<std::string> others;
  for (const auto& other : teams_) {
    if (other.get() != &team && !other->lost) others.insert(other->names.begin(), other->names.end());
  }
  std::vector<std::string> wanted = team.names;
  std::erase_if(wanted, [&](const std::string& name) { return others.contains(name); });
  while (!wanted.empty()) {
    try {
      return connection.Request(command::kClaim, {}, {}, Join(wanted, " "));
    } catch (const Error& e) {
      if (e.code() == kNoSuchName) return connection.Request(command::kClaim, {}, {}, team.text);
      if (e.code() != kOwned || std::erase(wanted, FirstWord(e.text())) == 0) throw;
    }
  }
  if (!team.names.empty()) return connection.Request(command::kGetTeam);  // none is left
  return connection.Request(command::kClaim, {}, {}, team.text);
}

void Session::NotOurs(const TeamLink& team, const Error& owned) const {
  const std::string robot = FirstWord(owned.text());
  for (const auto& other : teams_) {
    if (other->lost || std::find(other->names.begin(), other->names.end(), robot) == other->names.end())
      continue;
    throw Error(kOwned, "robot " + robot + " belongs to your " + other->label() +
                            ": drive it there, or release that team first");
  }
  throw Error(kOwned, (team.one_word() ? team.label() : "the team with " + robot) + " cannot be driven: " +
                          owned.text() + ". Stop the other program, or free the robot on the page");
}

std::shared_ptr<TeamLink> Session::DriveTeam(const std::string& text) {
  RequireOpen();
  if (watch_) throw Error(kNotPossible, "this sim only watches; connect without watch to drive a team");
  const auto is_lost = [](const auto& team) { return team->lost.has_value(); };
  std::erase_if(teams_, is_lost);
  auto team = std::make_shared<TeamLink>();
  for (const auto& other : teams_) {
    if (other->text != text) continue;
    try {
      SettleTeam(*other);  // who is in it by now
      return other;
    } catch (const Error&) {
      if (!other->lost) throw;
    }
  }
  std::erase_if(teams_, is_lost);
  for (const auto& other : teams_) {  // what one of ours lets go of for a moment is not free
    if (other->names.empty() || (other->connection->is_open() && !other->connection->busy())) continue;
    try {
      SettleTeam(*other);
    } catch (const Error&) {
      // Its next use says what is wrong.
    }
  }
  while (std::any_of(teams_.begin(), teams_.end(), [&](const auto& t) { return t->number == team->number; }))
    ++team->number;
  team->text = text;
  team->connection = std::make_unique<Connection>(address_, "/swarm", team->number);
  try {
    OpenTeam(*team);
  } catch (const Error& e) {
    if (e.code() != kOwned) throw;
    if (LetGo(FirstWord(e.text()))) return DriveTeam(text);
    NotOurs(*team, e);
  }
  teams_.push_back(team);
  return team;
}

void Session::OpenTeam(TeamLink& team) {
  Connection& connection = *team.connection;
  connection.Open();
  try {
    if (team.names.empty()) connection.Request(command::kRelease);  // an older team may have been of others
    TakeTeam(team);
    if (team.names.empty()) throw Error(kNoSuchName, "there is no robot that nobody drives");
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
  if (team.stale && !team.playing.empty()) TakeTeam(team);
  if (team.stale) NameTeam(team, team.connection->Request(command::kGetTeam));
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

Message Session::AskTeam(TeamLink& team, std::int32_t command, std::vector<std::int32_t> params) {
  Connection& connection = SettleTeam(team);
  const std::int64_t since = reached_;
  try {
    Message reply = connection.Request(command, std::move(params), {}, "", kRequestTimeout_s, spin_s());
    Fresh(reply, since);
    return reply;
  } catch (const Closed& e) {
    Lose(e, team.label(), team.TakeAgain(), team.lost);
  } catch (const Error& e) {
    ThrowIfLoaded(e);
    throw;
  }
}

void Session::RefreshTeam(TeamLink& team) {
  NameTeam(team, AskTeam(team, command::kGetTeam));
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
  team.gone.clear();
  return std::move(*std::exchange(team.reply, std::nullopt));
}

std::vector<std::optional<Command>> Session::Kept() const {
  std::vector<std::optional<Command>> kept;
  for (const auto& link : links_) kept.push_back(link->kept);
  return kept;
}

void Session::Keep(std::vector<std::optional<Command>> kept) {
  for (std::size_t i = 0; i < kept.size() && i < links_.size(); ++i) links_[i]->kept = std::move(kept[i]);
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

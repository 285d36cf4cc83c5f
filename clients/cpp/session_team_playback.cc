// SPDX-License-Identifier: MIT
// The teams of a session while a recording is played: nobody can have the robots, so a team reads.
#include <algorithm>
#include <numeric>
#include <set>

#include "clients/cpp/codes.h"
#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

constexpr std::int32_t kMostGaps = 100000;

/// The NAME of a robot NAME_1, NAME_2 … of a swarm; else empty.
std::string SwarmOf(const std::string& robot) {
  const std::size_t bar = robot.rfind('_');
  if (bar == std::string::npos || bar + 1 == robot.size()) return "";
  const bool digits = robot.find_first_not_of("0123456789", bar + 1) == std::string::npos;
  return digits ? robot.substr(0, bar) : "";
}

/// The names of robots and swarms that are meant by what was asked for.
std::set<std::string> Meant(const std::vector<std::string>& asked, const std::vector<std::string>& there) {
  std::set<std::string> words(asked.begin(), asked.end()), known(there.begin(), there.end()), swarms;
  for (const std::string& robot : there) swarms.insert(SwarmOf(robot));
  swarms.erase("");
  known.insert(swarms.begin(), swarms.end());
  const bool all = std::includes(known.begin(), known.end(), words.begin(), words.end());
  if (swarms.size() == 1 && !all) words.merge(swarms);  // the section, swarm1, of the only swarm
  return words;
}

/// The ids of the n robots, in their order: from 1 on, with gaps where robots have been removed.
std::vector<std::int32_t> KnownIds(Connection& connection, std::size_t n) {
  std::vector<std::int32_t> ids(n);
  if (n == 0) return ids;
  const auto are_there = [&](const std::vector<std::int32_t>& wanted) {
    try {
      connection.Request(command::kReadAll, wanted);
      return true;
    } catch (const Error& e) {
      if (e.code() != kNoSuchName) throw;
      return false;
    }
  };
  std::iota(ids.begin(), ids.end(), 1);
  if (are_there(ids)) return ids;
  ids.clear();
  const auto last = static_cast<std::int32_t>(n) + kMostGaps;
  for (std::int32_t id = 1; ids.size() < n && id <= last; ++id) {
    if (are_there({id})) ids.push_back(id);
  }
  return ids;
}

}  // namespace

void Session::TakeTeam(TeamLink& team) {
  std::string playing;
  try {
    Message reply = Claim(team);
    if (!reply.params.empty() || Status()["playback"].is_null()) {
      team.playing.clear();
      NameTeam(team, std::move(reply));
      return;
    }
    playing = std::string(kPlaying) + ": sim.branch() goes on live from here";
  } catch (const Error& e) {
    if (e.code() == kOwned && !team.playing.empty()) NotOurs(team, e);  // a branch has gone on live meanwhile
    if (e.code() != kNotPossible || !e.text().starts_with(kPlaying)) throw;
    playing = e.text();
  }
  FindTeam(team);
  team.playing = playing;
}

void Session::FindTeam(TeamLink& team) {
  const std::vector<std::string> there = RobotNames();
  const std::vector<std::int32_t> ids = KnownIds(*team.connection, there.size());
  const std::vector<std::string> asked = Words(team.text);
  const std::set<std::string> words = Meant(asked, there);
  team.names.clear();
  team.ids.clear();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (!words.empty() && !words.contains(there[i]) && !words.contains(SwarmOf(there[i]))) continue;
    team.names.push_back(there[i]);
    team.ids.push_back(ids[i]);
  }
  team.stale = false;
  for (const auto& link : links_) {  // after a branch the team drives these
    if (!link->unclaimed || std::find(team.names.begin(), team.names.end(), link->robot) == team.names.end())
      continue;
    link->in_team = true;
    link->motors.reset();
  }
  if (!words.empty() && team.names.empty()) {
    throw Error(kNoSuchName, "none of " + ListOf(asked) +
                                 " is there at this moment of the recording under that name, write the NAME "
                                 "of a swarm or robots; there are: " +
                                 ListOf(there));
  }
}

void Session::OwnTeam(TeamLink& team) {
  SettleTeam(team);
  if (!team.playing.empty()) TakeTeam(team);
  if (!team.playing.empty()) throw Error(kNotPossible, team.playing);
}

Message Session::ReadTeam(TeamLink& team) {
  SettleTeam(team);
  if (team.playing.empty()) return AskTeam(team, command::kReadAll);
  Message reply;
  try {
    reply = AskTeam(team, command::kReadAll, team.ids);
  } catch (const Error& e) {
    if (e.code() != kNoSuchName) throw;
    FindTeam(team);  // at this moment there are others
    reply = AskTeam(team, command::kReadAll, team.ids);
  }
  Select(team, team.selected, team.neighbours);
  // Of robots that are not ours the daemon does not tell there how many distances they have.
  const auto distances = std::find(team.readings.begin(), team.readings.end(), "distances");
  if (distances != team.readings.end() && !reply.params.empty()) {
    team.columns[static_cast<std::size_t>(distances - team.readings.begin())] +=
        reply.params.back() - std::accumulate(team.columns.begin(), team.columns.end(), 0);
  }
  return reply;
}

}  // namespace coopdyn::client

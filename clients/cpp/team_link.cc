// SPDX-License-Identifier: MIT
#include "clients/cpp/links.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <set>
#include <utility>

#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

constexpr std::int32_t kMostGaps = 100000;  // between the ids of robots

/// The NAME of a robot NAME_1, NAME_2 … of a swarm; else empty.
std::string SwarmOf(const std::string& robot) {
  const std::size_t bar = robot.rfind('_');
  if (bar == std::string::npos || bar + 1 == robot.size()) return "";
  const bool digits = robot.find_first_not_of("0123456789", bar + 1) == std::string::npos;
  return digits ? robot.substr(0, bar) : "";
}

/// The names of robots and swarms that `asked` refers to.
std::set<std::string> Meant(const std::vector<std::string>& asked, const std::vector<std::string>& there) {
  std::set<std::string> words(asked.begin(), asked.end()), known(there.begin(), there.end()), swarms;
  for (const std::string& robot : there) swarms.insert(SwarmOf(robot));
  swarms.erase("");
  known.insert(swarms.begin(), swarms.end());
  const bool all = std::includes(known.begin(), known.end(), words.begin(), words.end());
  if (swarms.size() == 1 && !all) words.merge(swarms);  // `swarm1`, the section, stands for the only swarm
  return words;
}

}  // namespace

TeamLink::TeamLink(Session& session_of, std::string text_of, int number_of)
    : session(session_of),
      text(std::move(text_of)),
      number(number_of),
      connection(session.address(), "/swarm", true, number) {}

std::string TeamLink::label() const {
  return one_word() ? "team " + text : "team of " + std::to_string(names.size()) + " robots";
}

std::string TeamLink::TakeAgain() const {
  return text.empty() ? "sim.team()" : one_word() ? "sim.team(\"" + text + "\")" : "sim.team({...})";
}

bool TeamLink::Has(const std::string& robot) const {
  return !lost && std::find(names.begin(), names.end(), robot) != names.end();
}

void TeamLink::Name(Message said) {
  const std::vector<std::string> before = std::exchange(names, Words(said.text));
  ids = std::move(said.params);
  ids.resize(names.size());
  stale = false;
  if (names.size() < before.size()) {
    const std::set<std::string> left(names.begin(), names.end());
    std::copy_if(before.begin(), before.end(), std::back_inserter(gone),
                 [&](const std::string& name) { return !left.contains(name); });
  }
  if (before.empty() || !names.empty()) return;
  connection.Close();
  const std::string what = one_word() ? label() : "the team of " + std::to_string(before.size()) + " robots";
  lost.emplace(kNotPossible, what + " has lost all its robots, to other programs or another scenario: " +
                                 TakeAgain() + " takes those that it names now");
  session.ThrowIfLoaded(*lost);
  throw Error(*lost);
}

/// Claims the team's previous robots, not those that its name refers to now, and none that another team has.
Message TeamLink::Claim() {
  const auto claim = [&](std::string words) {
    return connection.Ask({.command = command::kClaim, .text = std::move(words)});
  };
  std::vector<std::string> wanted = names;
  std::erase_if(wanted, [&](const std::string& name) { return session.TeamWith(name, this) != nullptr; });
  while (!wanted.empty()) {
    try {
      return claim(Join(wanted, " "));
    } catch (const Error& e) {
      if (e.code() == kNoSuchName) return claim(text);
      if (e.code() != kOwned || std::erase(wanted, FirstWord(e.text())) == 0) throw;
    }
  }
  return names.empty() ? claim(text) : connection.Ask({command::kGetTeam});  // no robot is left
}

void TeamLink::ThrowOwned(const Error& owned) const {
  const std::string robot = FirstWord(owned.text());
  if (const TeamLink* other = session.TeamWith(robot, this))
    throw Error(kOwned, "robot " + robot + " belongs to your " + other->label() +
                            ": drive it there, or release that team first");
  throw Error(kOwned,
              (one_word() ? label() : "the team with " + robot) + " cannot be driven: " + owned.text());
}

void TeamLink::Open() {
  connection.Open();
  try {
    if (names.empty()) connection.Ask({command::kRelease});  // drop the robots of an older team
    Take();
    if (names.empty())
      throw Error(kNoSuchName, "no robot is free: other programs or loaded controllers drive them all");
    Select(selected, neighbours);
    session.Note(connection.Ask({command::kGetTime}));
  } catch (...) {
    connection.Close();
    throw;
  }
}

void TeamLink::Settle() {
  session.RequireOpen();
  if (lost) throw Error(*lost);
  if (!connection.is_open() || connection.busy()) Open();
  if (stale && !playing.empty()) Take();
  if (stale) Name(connection.Ask({command::kGetTeam}));
}

void TeamLink::Select(const std::string& words, int nearest) {
  std::vector<std::int32_t> params;
  if (words.find("neighbours") != std::string::npos) params.push_back(nearest);
  Message said = connection.Ask({command::kSelectReadings, params, {}, words});
  selected = words;
  neighbours = nearest;
  readings = Words(said.text);
  columns.clear();
  for (const std::int32_t count : said.params)
    columns.push_back(static_cast<std::size_t>(std::max(0, count)));
  columns.resize(readings.size());
}

Message TeamLink::Ask(std::int32_t command, std::vector<std::int32_t> params) {
  Settle();
  const std::int64_t since = session.reached();
  try {
    return session.Fresh(connection.Ask({command, std::move(params)}, session.polling()), since);
  } catch (const Closed& e) {
    Lose(e);
  } catch (const Error& e) {
    session.ThrowIfLoaded(e);
    throw;
  }
}

void TeamLink::Lose(const Closed& closed) {
  session.Lose(closed, label(), TakeAgain(), lost);
}

void TeamLink::Refresh() {
  Name(Ask(command::kGetTeam));
  Select(selected, neighbours);
}

void TeamLink::GiveUp(bool stop) {
  if (connection.is_open() && !lost) {
    try {
      if (stop) connection.Send(command::kStopTeam);
      connection.Send(command::kRelease);
      connection.FinishSending();
      connection.AwaitEnd(After(kCloseGrace_s));
    } catch (const Error&) {
      // Already closed.
    }
  }
  connection.Close();
  if (!lost) lost.emplace(kNotPossible, label() + " was given up; " + TakeAgain() + " takes it again");
}

void TeamLink::Take() {
  std::string why;
  try {
    Message said = Claim();
    if (!said.params.empty() || session.Status()["playback"].is_null()) {
      playing.clear();
      Name(std::move(said));
      return;
    }
    why = std::string(kPlaying) + ": sim.branch() goes on live from here";
  } catch (const Error& e) {
    if (e.code() == kOwned && !playing.empty()) ThrowOwned(e);  // a branch has ended the playback
    if (e.code() != kNotPossible || !e.text().starts_with(kPlaying)) throw;
    why = e.text();
  }
  Find();
  playing = why;
}

void TeamLink::Find() {
  const std::vector<std::string> there = session.RobotNames();
  const std::vector<std::int32_t> known = KnownIds(there.size());
  const std::vector<std::string> asked = Words(text);
  const std::set<std::string> words = Meant(asked, there);
  names.clear();
  ids.clear();
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (!words.empty() && !words.contains(there[i]) && !words.contains(SwarmOf(there[i]))) continue;
    names.push_back(there[i]);
    ids.push_back(known[i]);
  }
  stale = false;
  session.GiveToTeam(names);
  if (!words.empty() && names.empty()) {
    throw Error(kNoSuchName, "none of " + ListOf(asked) +
                                 " is there at this moment of the recording under that name, write the NAME "
                                 "of a swarm or robots; there are: " +
                                 ListOf(there));
  }
}

std::vector<std::int32_t> TeamLink::KnownIds(std::size_t n) {
  std::vector<std::int32_t> known(n);
  if (n == 0) return known;
  const auto are_there = [&](const std::vector<std::int32_t>& wanted) {
    try {
      connection.Ask({command::kReadAll, wanted});
      return true;
    } catch (const Error& e) {
      if (e.code() != kNoSuchName) throw;
      return false;
    }
  };
  std::iota(known.begin(), known.end(), 1);
  if (are_there(known)) return known;
  known.clear();
  const auto last = static_cast<std::int32_t>(n) + kMostGaps;
  for (std::int32_t id = 1; known.size() < n && id <= last; ++id) {
    if (are_there({id})) known.push_back(id);
  }
  return known;
}

void TeamLink::Own() {
  Settle();
  if (!playing.empty()) Take();
  if (!playing.empty()) throw Error(kNotPossible, playing);
}

Message TeamLink::Read() {
  Settle();
  if (playing.empty()) return Ask(command::kReadAll);
  Message read;
  try {
    read = Ask(command::kReadAll, ids);
  } catch (const Error& e) {
    if (e.code() != kNoSuchName) throw;
    Find();  // the recording has other robots at this moment
    read = Ask(command::kReadAll, ids);
  }
  Select(selected, neighbours);
  // For robots that the team does not own, the reply to select_readings lacks the number of distances.
  const auto distances = std::find(readings.begin(), readings.end(), "distances");
  if (distances != readings.end() && !read.params.empty()) {
    std::size_t& count = columns[static_cast<std::size_t>(distances - readings.begin())];
    const std::size_t others = std::accumulate(columns.begin(), columns.end(), std::size_t{0}) - count;
    const auto all = static_cast<std::size_t>(std::max(0, read.params.back()));
    count = all > others ? all - others : 0;
  }
  return read;
}

}  // namespace coopdyn::client

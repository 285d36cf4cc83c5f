// SPDX-License-Identifier: MIT
// What a session does when its world begins anew: after a reset, load or restore, its own or somebody else's.
#include <algorithm>
#include <set>
#include <utility>

#include "clients/cpp/codes.h"
#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {

const Message& Session::Fresh(const Message& reply, std::int64_t since) {
  Note(reply);
  GoOn(steps_, since);
  return reply;
}

void Session::GoOn(std::int64_t step, std::int64_t since) {
  if (step >= since) {
    reached_ = std::max(reached_, step);
  } else if (watch_ || !Status()["playback"].is_null()) {
    reached_ = step;
  } else {
    throw NewWorld();
  }
}

WorldReset Session::NewWorld(const std::string& word) {
  const std::string before = std::exchange(scenario_, Status()["scenario"].text());
  const std::string cure = ": run your program again, or catch this to start over";
  if (word != kLoad && scenario_ == before) {
    StartedAnew();
    return WorldReset("the world was reset" + cure);
  }
  const std::vector<std::string> gone = Loaded();
  const std::string which =
      scenario_.empty() ? "a scenario was loaded" : "scenario " + scenario_ + " was loaded";
  if (gone.empty()) return WorldReset(which + cure);
  return WorldReset(which + ", which has no " + ListOf(gone) + "; there are: " + ListOf(RobotNames()) +
                    ". Run your program again with these");
}

void Session::ThrowIfLoaded(const Error& error) {
  if (dynamic_cast<const WorldReset*>(&error) != nullptr) return;
  const Json status = Status();
  const bool same =
      status["scenario"].text() == scenario_ && status["step"].number() >= static_cast<double>(reached_);
  if (!same && status["playback"].is_null()) throw NewWorld(kLoad);
}

void Session::StartedAnew() {
  reached_ = 0;
  ForgetCommands();
}

void Session::ForgetCommands() {
  for (const auto& link : links_) {
    link->ForgetCommands();
    link->another = false;
  }
  for (const auto& team : teams_) team->stale = true;
}

void Session::Jumped() {
  StartedAnew();
  Control(command::kGetTime);  // tells the mode
  const std::vector<std::string> names = RobotNames();
  const std::set<std::string> here(names.begin(), names.end());
  const auto is_here = [&](const std::string& name) { return here.contains(name); };
  const bool all =
      std::all_of(links_.begin(), links_.end(), [&](const auto& link) { return is_here(link->robot); }) &&
      std::all_of(teams_.begin(), teams_.end(), [&](const auto& team) {
        return std::all_of(team->names.begin(), team->names.end(), is_here);
      });
  if (!all) Loaded();
}

std::vector<std::string> Session::Loaded() {
  StartedAnew();
  scenario_ = Status()["scenario"].text();
  for (const auto& team : teams_) {  // opened again with the robots there are now
    team->connection->Close();
    team->names.clear();
    if (team->lost && team->lost->code() == kNotPossible) team->lost.reset();  // it had no robots left
  }
  const std::vector<std::string> names = RobotNames();
  std::vector<std::string> gone;
  std::erase_if(links_, [&](const auto& link) {
    if (std::find(names.begin(), names.end(), link->robot) != names.end()) return false;
    link->lost.emplace(
        kNoSuchName, "the scenario that was loaded has no " + link->robot + "; there are: " + ListOf(names));
    link->Close();
    gone.push_back(link->robot);
    return true;
  });
  return gone;
}

}  // namespace coopdyn::client

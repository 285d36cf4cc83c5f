// SPDX-License-Identifier: MIT
#include "clients/cpp/session.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <set>
#include <utility>

#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

constexpr int kUnstepped = 200;               // commands to one robot without a step before a notice
constexpr std::int32_t kStatusRobots = 1000;  // robots in one status

bool CarriesMode(std::int32_t id) {
  return id == command::kReady || id == command::kGetTime || id == command::kSetWheelSpeeds ||
         id == command::kSetVelocity || id == command::kStop || id == command::kStepAll ||
         (id >= command::kSetPositions && id <= command::kSetModes) || id == command::kHold ||
         id == command::kSetPwm || id == command::kSetActivations || id == command::kSetThrusts ||
         id == command::kSetMotors;
}

}  // namespace

Polling* Session::polling() {
  if (const char* given = std::getenv("COOPDYN_SPIN")) {
    polling_.set_spin(std::max(0.0, std::atof(given)) * 1e-6);
  } else {
    polling_.set_spin(mode_ == kLockstep && links_.size() + teams_.size() <= 4 ? 50e-6 : 0);
  }
  return &polling_;
}

void Session::RequireOpen() const {
  if (closed_) throw Error(Error::kNoConnection, "this sim is closed; connect() again");
}

void Session::RequireDriving() const {
  RequireOpen();
  if (watch_) throw Error(kNotPossible, "this sim only watches; connect without watch to drive");
}

Connection& Session::Of(const std::string& module) {
  RequireOpen();
  const bool drives = !watch_ || module == kSimulation;
  Connection& connection = modules_.try_emplace(module, address_, module, drives).first->second;
  connection.KeepOpen();
  return connection;
}

Message Session::RequestGlobal(const std::string& module, Request request) {
  Message reply = Of(module).Ask(std::move(request));
  for (const auto& link : links_) link->carried.reset();
  Note(reply);
  return reply;
}

int Session::AskMode() {
  const Message reply = Control({command::kGetTime});
  Require(reply, 1, 0);
  return reply.params[0];
}

Json Session::Status() {
  return Json::Parse(Control({command::kGetStatus}).text);
}

std::vector<std::string> Session::RobotNames() {
  std::vector<std::string> names;
  for (const Json& robot : Robots()) names.push_back(robot["name"].text());
  return names;
}

std::map<std::string, std::string> Session::ModulesOf(const std::string& robot) {
  std::map<std::string, std::string> names;
  for (const Json& status : Robots()) {
    if (status["name"].text() != robot) continue;
    for (const Json& module : status["modules"].items()) {
      const std::string& type = module["type"].text();
      const std::string& path = module["name"].text();
      const std::string name = path.substr(path.rfind('/') + 1);
      if (name == type || !names.contains(type)) names[type] = name;
    }
  }
  return names;
}

std::vector<std::pair<std::string, std::string>> Session::ActuatorsOf(const std::string& robot) {
  if (!actuators_.contains(robot)) {
    static const std::set<std::string> kTypes = {kMotors, kJoints, "muscles", "thrusters", kChannel};
    actuators_.clear();
    for (const Json& status : Robots()) {
      auto& actuators = actuators_[status["name"].text()];
      for (const Json& module : status["modules"].items()) {
        const std::string &path = module["name"].text(), &type = module["type"].text();
        if (kTypes.contains(type)) actuators.emplace_back(path.substr(path.rfind('/') + 1), type);
      }
    }
  }
  const auto found = actuators_.find(robot);
  return found != actuators_.end() ? found->second : std::vector<std::pair<std::string, std::string>>{};
}

std::vector<std::string> Session::GroupsOf(const std::string& robot) {
  std::vector<std::string> groups;
  for (const auto& [name, type] : ActuatorsOf(robot)) {
    if (type == kJoints) groups.push_back(name);
  }
  return groups;
}

std::vector<Json> Session::Robots() {
  std::vector<Json> robots;
  while (true) {  // one status lists only some of them
    const auto first = static_cast<std::int32_t>(robots.size() + 1);
    const Json status = Json::Parse(Control({command::kGetStatus, {first, kStatusRobots}}).text);
    const std::vector<Json>& more = status["robots"].items();
    robots.insert(robots.end(), more.begin(), more.end());
    if (more.size() < kStatusRobots || static_cast<double>(robots.size()) >= status["robot_count"].number())
      return robots;
  }
}

Json Session::Describe(const std::string& module) {
  RequireOpen();
  Connection connection(address_, module, false);
  return Json::Parse(Ask(connection, {command::kDescribe}).text);
}

Message Session::Ask(Connection& connection, const Request& request) {
  if (connection.is_open() && !connection.busy()) {
    try {
      return Note(connection.Ask(request, polling()));
    } catch (const Closed&) {
    }
  }
  connection.Open();
  return Note(connection.Ask(request));
}

Message Session::Call(const std::string& module, Request request) {
  RequireOpen();
  RobotLink* link = nullptr;
  for (const auto& candidate : links_) {
    candidate->carried.reset();
    if (candidate->motors && candidate->motors->module() == module) link = candidate.get();
  }
  if (link != nullptr) link->Settle();
  Connection& connection = link != nullptr ? *link->motors : Of(module);
  std::vector<Waiting> waiting = {{&connection, link}};
  try {
    connection.Send(request.command, std::move(request.params), request.data, std::move(request.text));
    Message reply = Collect(waiting, request.timeout_s).last;
    if (module == kSimulation || module == "/playback") reached_ = 0;  // it may have been a reset
    return reply;
  } catch (const Error& e) {
    GiveUp(waiting, e);
    throw;
  }
}

std::shared_ptr<RobotLink> Session::Drive(const std::string& robot) {
  RequireOpen();
  const bool in_team = TeamWith(robot) != nullptr;
  std::erase_if(links_, [&](const auto& link) {
    return link->robot == robot && (link->lost || link->in_team != in_team);
  });
  for (const auto& link : links_) {
    if (link->robot == robot) return link;
  }
  auto link = std::make_shared<RobotLink>(*this, robot);
  link->in_team = in_team;
  link->Take();
  links_.push_back(link);
  links_.insert(links_.end(), link->others.begin(), link->others.end());
  return link;
}

bool Session::ReleaseIfUnused(const std::string& robot) {
  const auto of_robot = [&](const auto& link) { return link->robot == robot; };
  if (std::any_of(links_.begin(), links_.end(),
                  [&](const auto& link) { return of_robot(link) && link->commanded; }))
    return false;
  return std::count_if(links_.begin(), links_.end(),
                       [&](const auto& link) { return of_robot(link) && link->ReleaseIfUnused(); }) > 0;
}

void Session::LoseOthers(const RobotLink& lost) {
  for (const auto& link : links_) {
    if (link->robot != lost.robot || link.get() == &lost || link->in_team) continue;
    link->lost.emplace(*lost.lost);
    link->ForgetCommands();
    if (link->motors) link->motors->Close();
  }
}

std::shared_ptr<TeamLink> Session::DriveTeam(const std::string& text) {
  RequireDriving();
  std::set<int> numbers;
  // Reopen broken teams first, so that they claim their robots again: robots that one of our teams has lost
  // only for a moment are not free for the new team.
  for (const auto& team : teams_) {
    const bool same = team->text == text;
    if (team->lost ||
        (!same && (team->names.empty() || (team->connection.is_open() && !team->connection.busy()))))
      continue;
    try {
      team->Settle();
      if (same) return team;
    } catch (const Error&) {
      if (same && !team->lost) throw;  // the next use of another team reports the error
    }
  }
  std::erase_if(teams_, [](const auto& team) { return team->lost.has_value(); });
  for (const auto& team : teams_) numbers.insert(team->number);
  int number = 1;
  while (numbers.contains(number)) ++number;
  auto team = std::make_shared<TeamLink>(*this, text, number);
  try {
    team->Open();
  } catch (const Error& e) {
    if (e.code() != kOwned) throw;
    const std::string robot = FirstWord(e.text());
    if (ReleaseIfUnused(robot)) return DriveTeam(text);
    team->ThrowOwned(e);
  }
  teams_.push_back(team);
  return team;
}

const TeamLink* Session::TeamWith(const std::string& robot, const TeamLink* but) const {
  for (const auto& team : teams_) {
    if (team.get() != but && team->Has(robot)) return team.get();
  }
  return nullptr;
}

void Session::GiveToTeam(const std::vector<std::string>& robots) {
  for (const auto& link : links_) {
    if (!link->unclaimed || std::find(robots.begin(), robots.end(), link->robot) == robots.end()) continue;
    link->in_team = true;
    link->motors.reset();
  }
}

void Session::CloseTeam(TeamLink& team, bool stop) {
  team.GiveUp(stop);
  std::erase_if(teams_, [&](const auto& other) { return other.get() == &team; });
}

std::vector<std::optional<Command>> Session::Kept() const {
  std::vector<std::optional<Command>> kept;
  for (const auto& link : links_) kept.push_back(link->kept);
  return kept;
}

void Session::Keep(std::vector<std::optional<Command>> kept) {
  for (std::size_t i = 0; i < kept.size() && i < links_.size(); ++i) links_[i]->kept = std::move(kept[i]);
}

void Session::CountUnstepped(RobotLink& link) {
  if (++link.unstepped == 1) link.unstepped_since = steps_;
  if (link.unstepped < kUnstepped || warned_to_step_) return;
  link.unstepped = 0;
  const bool lockstep = mode_ == kLockstep;
  if (!lockstep && 2 * (steps_ - link.unstepped_since) >= kUnstepped) return;
  warned_to_step_ = true;
  std::cerr << "coopdyn: " << kUnstepped << " commands to " << link.robot << " without a step, "
            << (lockstep ? "nothing moves" : "your loop runs faster than time")
            << ": write sim.step() at the end of your loop" << std::endl;
}

void Session::Lose(const Closed& closed, const std::string& label, const std::string& take_again,
                   std::optional<Error>& lost) {
  if (closed.notice().empty())
    throw Error(Error::kNoConnection, "the connection to " + label + " broke; " + address_.LossHint());
  if (closed.by_load()) throw NewWorld(kLoad);
  // Reopening the connection would take the robot back from its new owner.
  lost.emplace(kOwned, label + " is no longer driven by this sim: " + closed.notice() + "; " + take_again +
                           " takes it again");
  throw Error(*lost);
}

const Message& Session::Note(const Message& reply) {
  if (reply.data.size() >= 2) {
    time_ = TimeOf(reply);
    steps_ = StepOf(reply);
  }
  if (!reply.params.empty() && CarriesMode(reply.command)) mode_ = reply.params[0];
  return reply;
}

Message Session::Fresh(Message reply, std::int64_t since) {
  Note(reply);
  Resume(steps_, since);
  return reply;
}

void Session::Resume(std::int64_t step, std::int64_t since) {
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
    OnReset();
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
  if (IsNew(Status())) throw NewWorld(kLoad);
}

bool Session::IsNew(const Json& status) const {
  const bool same =
      status["scenario"].text() == scenario_ && status["step"].number() >= static_cast<double>(reached_);
  return !same && status["playback"].is_null();
}

void Session::OnReset() {
  reached_ = 0;
  actuators_.clear();
  ForgetCommands();
}

void Session::ForgetCommands() {
  for (const auto& link : links_) {
    link->ForgetCommands();
    link->another = false;
  }
  for (const auto& team : teams_) team->stale = true;
}

void Session::OnRestored() {
  OnReset();
  Control({command::kGetTime});  // updates the mode
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
  OnReset();
  scenario_ = Status()["scenario"].text();
  for (const auto& team : teams_) {  // reopens with the present robots
    team->connection.Close();
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
    if (std::find(gone.begin(), gone.end(), link->robot) == gone.end()) gone.push_back(link->robot);
    return true;
  });
  for (const auto& link : links_) link->modules.clear();
  return gone;
}

void Session::Close() {
  if (closed_) return;
  daemon_.reset();  // first: a robot's last `stop` would run another step
  for (const auto& team : std::exchange(teams_, {})) team->GiveUp(true);
  closed_ = true;
  for (const auto& link : links_) {
    if (watch_ || !link->is_ours()) continue;
    try {
      const std::int32_t still = link->type == kMotors   ? command::kStop
                                 : link->type == kJoints ? command::kHold
                                                         : command::kReady;
      const Command last = link->last.value_or(Command{still});
      link->motors->Send(last.id, {}, last.data);
      link->motors->FinishSending();
    } catch (const Error&) {
      // Already closed.
    }
  }
  // Give the daemon time to read the last `stop`, so that this program's next request, e.g. a reset, comes
  // after it. Do not wait for its reply: in lockstep, the step may be far off.
  const Deadline deadline = After(kCloseGrace_s);
  for (const auto& link : links_) {
    if (!watch_ && link->is_ours()) link->motors->AwaitEnd(deadline);
    link->Close();
  }
  modules_.clear();
}

}  // namespace coopdyn::client

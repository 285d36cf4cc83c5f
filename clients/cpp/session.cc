// SPDX-License-Identifier: MIT
#include "clients/cpp/session.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <set>
#include <utility>

#include "clients/cpp/codes.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

constexpr int kLockstep = 1;
constexpr double kCommandWait_s = 0.1;  // for the reply to an actuator command in real time
constexpr int kUnstepped = 200;         // commands to one robot without a step: then a notice

bool CarriesMode(std::int32_t id) {
  return id == command::kReady || id == command::kGetTime || id == command::kSetWheelSpeeds ||
         id == command::kSetVelocity || id == command::kStop || id == command::kStepAll;
}

}  // namespace

void Link::ForgetCommands() {
  kept.reset();
  sent.reset();
  carried.reset();
}

void Link::Close() {
  if (motors) motors->Close();
  readers.clear();
  pushers.clear();
}

Session::Session(Address address, bool watch)
    : address_(std::move(address)), watch_(watch), simulation_(address_, "/simulation", true) {}

double Session::spin_s() const {
  if (const char* given = std::getenv("COOPDYN_SPIN")) return std::max(0.0, std::atof(given)) * 1e-6;
  return mode_ == kLockstep && links_.size() + teams_.size() <= 4 ? 50e-6 : 0;
}

const Message& Session::Note(const Message& reply) {
  if (reply.data.size() >= 2) {
    time_ = reply.data[reply.data.size() - 2];
    steps_ = static_cast<std::int64_t>(reply.data.back());
  }
  if (!reply.params.empty() && CarriesMode(reply.command)) mode_ = reply.params[0];
  return reply;
}

void Session::CountUnstepped(Link& link) {
  if (++link.unstepped == 1) link.unstepped_since = steps_;
  if (link.unstepped < kUnstepped || told_to_step_) return;
  link.unstepped = 0;
  const bool lockstep = mode_ == kLockstep;
  if (!lockstep && 2 * (steps_ - link.unstepped_since) >= kUnstepped) return;
  told_to_step_ = true;
  std::cerr << "coopdyn: " << kUnstepped << " commands to " << link.robot << " without a step, "
            << (lockstep ? "nothing moves" : "your loop runs faster than time")
            << ": write sim.step() at the end of your loop" << std::endl;
}

void Session::RequireOpen() const {
  if (closed_) throw Error(Error::kNoConnection, "this sim is closed; connect() again");
}

Message Session::Call(const std::string& module, std::int32_t command, std::vector<std::int32_t> params,
                      std::vector<double> data, std::string text, double timeout_s) {
  RequireOpen();
  Link* link = nullptr;
  for (const auto& candidate : links_) {
    candidate->carried.reset();
    if (candidate->motors && candidate->motors->module() == module) link = candidate.get();
  }
  Connection* connection = &simulation_;
  if (link != nullptr) {
    Settle(*link);
    connection = link->motors.get();
  } else if (module != "/simulation") {
    std::unique_ptr<Connection>& other = others_[module];
    if (!other) other = std::make_unique<Connection>(address_, module, !watch_);
    connection = other.get();
  }
  if (link == nullptr && !connection->Alive()) connection->Open();
  std::vector<Waiting> waiting = {{connection, link}};
  try {
    connection->Send(command, std::move(params), data, std::move(text));
    Message reply = Collect(waiting, timeout_s);
    if (module == "/simulation" || module == "/playback") reached_ = 0;  // it may have been a reset
    return reply;
  } catch (...) {
    GiveUp(waiting, std::current_exception());
    throw;
  }
}

std::shared_ptr<Link> Session::Drive(const std::string& robot) {
  RequireOpen();
  const bool in_team = HasTeamWith(robot);
  std::erase_if(links_, [&](const auto& link) {
    return link->robot == robot && (link->lost || link->in_team != in_team);
  });
  for (const auto& link : links_) {
    if (link->robot == robot) return link;
  }
  auto link = std::make_shared<Link>();
  link->robot = robot;
  if (in_team) {
    link->in_team = true;
    links_.push_back(link);
    return link;
  }
  link->motors = std::make_unique<Connection>(address_, "/" + robot + "/motors", !watch_);
  try {
    OpenMotors(*link);
  } catch (const Error& e) {
    if (e.code() != kNoSuchName) throw;
    std::set<std::string> robots;
    for (const Module& module : address_.Modules()) {
      const std::size_t slash = module.name.find('/', 1);
      if (slash != std::string::npos) robots.insert(module.name.substr(1, slash - 1));
    }
    if (!robots.contains(robot))
      throw Error(kNoSuchName, "there is no robot '" + robot + "'; " +
                                   Nearest(robot, {robots.begin(), robots.end()}) +
                                   "there are: " + ListOf({robots.begin(), robots.end()}));
    link->motors.reset();  // it has no motors: it can be read only
  }
  links_.push_back(link);
  return link;
}

void Session::OpenMotors(Link& link) {
  link.sent.reset();
  link.carried.reset();
  Connection& motors = *link.motors;
  motors.Open();
  try {
    if (!watch_) {
      try {
        Claim(link);
      } catch (const Error& e) {
        if (e.code() != kNotPossible && !link.another)
          throw;  // not possible: a recording is played; reading goes on
      }
    }
    if (!link.attached.empty()) motors.Request(command::kAttach, {}, {}, Join(link.attached, " "));
    if (watch_ || link.unclaimed) Note(motors.Request(command::kGetTime));
  } catch (...) {
    motors.Close();
    throw;
  }
}

void Session::Claim(Link& link) {
  link.unclaimed = true;
  try {
    link.motors->Request(command::kClaim);
  } catch (const Error& e) {
    if (e.code() != kOwned) throw;
    if (HasTeamWith(link.robot)) throw Error(kNotPossible, link.robot + " is driven by its team");
    throw Error(kOwned, link.robot + " cannot be driven: " + e.what() +
                            ". Stop the other program, or free the robot on the page; to watch only: "
                            "connect with watch = true");
  }
  link.unclaimed = link.another = false;
  Note(link.motors->Request(command::kGetTime));  // a branch may have brought another mode
}

void Session::Settle(Link& link) {
  if (link.lost) throw Error(*link.lost);
  Connection& motors = *link.motors;
  if (!motors.is_open() || (motors.busy() && !link.sent)) OpenMotors(link);
  if (!link.sent || AwaitCommand(link)) return;
  // No reply: in lockstep it comes after the step only. Take the command back, and keep it.
  if (Control(command::kGetTime).params.at(0) == kLockstep) {
    if (!link.kept) link.kept = link.sent;
    OpenMotors(link);
    return;
  }
  try {
    const Message reply = motors.Receive(kRequestTimeout_s, 0);
    link.sent.reset();
    Note(Checked(reply));
  } catch (const Closed& e) {
    Lose(link, e);
  }
}

bool Session::TakesPart(Link& link) {
  if (!link.motors) return false;
  Settle(link);
  if (link.unclaimed && !link.another) {
    try {
      Claim(link);
    } catch (const Error& e) {
      if (e.code() != kNotPossible && e.code() != kOwned) throw;
      link.another = !e.text().starts_with(kPlaying);
    }
  }
  return !link.unclaimed;
}

bool Session::LetGo(const std::string& robot) {
  for (const auto& link : links_) {
    if (link->robot != robot || !link->motors || link->commanded || link->unclaimed || link->lost) continue;
    Settle(*link);
    link->motors->Request(command::kRelease);
    link->ForgetCommands();
    link->unclaimed = link->another = true;
    return true;
  }
  return false;
}

bool Session::HasTeamWith(const std::string& robot) const {
  return std::any_of(teams_.begin(), teams_.end(), [&](const auto& team) {
    return !team->lost && std::find(team->names.begin(), team->names.end(), robot) != team->names.end();
  });
}

bool Session::AwaitCommand(Link& link) {
  const Deadline deadline = After(kCommandWait_s);
  while (true) {
    std::optional<Message> reply;
    try {
      reply = link.motors->TryRead();
    } catch (const Closed& e) {
      Lose(link, e);
    }
    if (reply) {
      link.sent.reset();
      Fresh(Checked(std::move(*reply)), link.sent_at);
      return true;
    }
    if (Until(deadline) <= 0) return false;
    WaitReadable({link.motors->fd()}, Until(deadline));
  }
}

void Session::Lose(Link& link, const Closed& closed) {
  link.ForgetCommands();
  Lose(closed, link.robot, "sim.robot(\"" + link.robot + "\")", link.lost);
}

void Session::Lose(const Closed& closed, const std::string& label, const std::string& take_again,
                   std::optional<Error>& lost) {
  if (closed.notice().empty())
    throw Error(Error::kNoConnection, "the connection to " + label + " broke; is the daemon still running?");
  if (closed.by_load()) throw NewWorld(kLoad);
  // Opening it again would take the robot back from whoever got it.
  lost.emplace(kOwned, label + " is not driven by this sim any more: " + closed.notice() + "; " + take_again +
                           " takes it again");
  throw Error(*lost);
}

void Session::Actuate(Link& link, std::int32_t command, std::vector<double> data) {
  RequireOpen();
  if (watch_) throw Error(kNotPossible, "this sim only watches; connect without watch to drive");
  if (!link.motors)
    throw Error(kNotPossible, link.robot + (link.in_team ? " is driven by its team" : " has no motors"));
  if (link.lost) throw Error(*link.lost);
  if (mode_ != kLockstep || link.unclaimed) Settle(link);
  if (link.unclaimed) Claim(link);  // a branch may go on live from there
  link.commanded = true;
  if (mode_ == kLockstep) {
    if (link.kept) CountUnstepped(link);
    link.kept = Command{command, std::move(data)};
    return;
  }
  link.kept.reset();
  CountUnstepped(link);
  link.sent_at = reached_;
  try {
    link.motors->Send(command, {}, data);
  } catch (const Closed& e) {
    Lose(link, e);
  }
  link.sent = Command{command, std::move(data)};
  AwaitCommand(link);
}

void Session::Step(int n, double timeout_s, const TeamCommand& team_command) {
  RequireOpen();
  std::vector<Waiting> waiting;
  for (const auto& link : links_) link->unstepped = 0;
  if (!watch_) {
    std::vector<TeamLink*> settled;
    for (const auto& team : teams_) {
      try {
        SettleTeam(*team);
        settled.push_back(team.get());
      } catch (const Error&) {
        // The others go on without one that is lost, or whose robots are another's after a load.
        if (team.get() == team_command.team || (!team->lost && !team->names.empty())) throw;
      }
    }
    std::erase_if(teams_, [](const auto& team) { return team->lost.has_value(); });
    for (const auto& link : links_) {
      if (TakesPart(*link)) waiting.push_back({link->motors.get(), link.get()});
    }
    for (TeamLink* team : settled) waiting.push_back({team->connection.get(), nullptr, team});
  }
  if (waiting.empty()) {
    if (!simulation_.Alive()) simulation_.Open();
    waiting.push_back({&simulation_, nullptr});
  }
  const std::int64_t since = reached_ + 1;
  try {
    for (Waiting& w : waiting) {
      if (w.team != nullptr) {
        if (w.team == team_command.team) {
          w.connection->Send(command::kStepAll, {}, team_command.values, team_command.text);
        } else {
          w.connection->Send(command::kReady, {n}, {});
        }
        continue;
      }
      Command command{command::kReady, {}};
      if (w.link != nullptr) {
        if (w.link->kept) command = std::move(*w.link->kept);
        w.link->kept.reset();
        w.link->carried.reset();
      }
      w.connection->Send(command.id, {n}, command.data);
    }
    Collect(waiting, timeout_s);
  } catch (...) {
    GiveUp(waiting, std::current_exception());
    throw;
  }
  GoOn(earliest_, since);
}

void Session::Close() {
  if (closed_) return;
  while (!teams_.empty()) CloseTeam(*std::shared_ptr<TeamLink>(teams_.back()), true);
  closed_ = true;
  const auto is_ours = [&](const Link& link) {
    return link.motors && link.motors->is_open() && !watch_ && !link.unclaimed && !link.lost;
  };
  for (const auto& link : links_) {
    if (!is_ours(*link)) continue;
    try {
      link->motors->Send(command::kStop, {}, {});
      link->motors->FinishSending();
    } catch (const Error&) {
      // It is gone already.
    }
  }
  // Lets the daemon read the last `stop`, so that what this program does next, a reset say, comes after it.
  // In lockstep the step it asks for may be far off.
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(200);
  for (const auto& link : links_) {
    if (is_ours(*link)) link->motors->AwaitEnd(deadline);
    link->ForgetCommands();
    link->Close();
  }
  others_.clear();
  simulation_.Close();
}

}  // namespace coopdyn::client

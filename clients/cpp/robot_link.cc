// SPDX-License-Identifier: MIT
#include "clients/cpp/links.h"

#include <algorithm>
#include <utility>

#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

constexpr double kCommandWait_s = 0.1;  // for the reply to an actuator command in real time

/// For each module, a shipped type of robot that has it; "": none.
const std::map<std::string, std::string>& WhoHas() {
  static const std::map<std::string, std::string> types = {
      {"neighbours", "minibot"}, {"compass", "minibot"}, {"support", "transporter"},   {"imu", "balancer"},
      {"wrench", "humanoid"},    {"lidar", "turtle"},    {"contact", "turtle"},        {"battery", "turtle"},
      {"odometry", "turtle"},    {"sonar", ""},          {"camera", "coopbot_camera"}, {"infrared", ""},
      {"light", "moth"}};
  return types;
}

}  // namespace

Command Command::After(const std::optional<Command>& kept, const std::string& whose) const {
  const auto has = [](const std::vector<std::int32_t>& ids, std::int32_t id) {
    return std::find(ids.begin(), ids.end(), id) != ids.end();
  };
  if (!kept || std::all_of(kept->joints.begin(), kept->joints.end(), [&](auto k) { return has(joints, k); }))
    return *this;
  if (kept->id != id)
    throw Error(kNotPossible, "two commands for different joints cannot go with one step of " + whose +
                                  ": write sim.step() between them, or command the joints alike");
  Command both = *this;
  for (std::size_t i = 0; i < kept->joints.size(); ++i) {
    if (has(joints, kept->joints[i])) continue;
    both.joints.push_back(kept->joints[i]);
    if (!data.empty()) both.data.push_back(kept->data[i]);
  }
  return both;
}

void RobotLink::Take() {
  const auto open = [this](RobotLink& link, const std::string& module) {
    link.motors = std::make_unique<Connection>(session.address(), Path(module), !session.watches());
    link.OpenMotors();
  };
  try {
    if (!in_team) open(*this, kMotors);
  } catch (const Error& e) {
    if (e.code() != kNoSuchName) throw;
    const std::vector<std::string> robots = session.RobotNames();
    if (std::find(robots.begin(), robots.end(), robot) == robots.end())
      throw Error(kNoSuchName, "there is no robot '" + robot + "'; " + Nearest(robot, robots) +
                                   "there are: " + ListOf(robots));
    if (FindAgain(kMotors, *motors)) {
      OpenMotors();
    } else {
      motors.reset();  // it has no motors
    }
  }
  for (const auto& [name, its_type] : session.ActuatorsOf(robot)) {
    if (its_type == kMotors || its_type == kChannel) continue;
    if (!motors && !in_team) {
      actuator = name;
      type = its_type;
      open(*this, name);
      continue;
    }
    others.push_back(std::make_shared<RobotLink>(session, robot, name, its_type));
    others.back()->in_team = in_team;
    if (!in_team) open(*others.back(), name);
  }
}

std::shared_ptr<RobotLink> RobotLink::TakeChannel(const std::string& name) {
  auto channel = std::make_shared<RobotLink>(session, robot, name, kChannel);
  channel->in_team = in_team;
  if (!in_team) {
    GiveToChannel();
    for (const auto& other : others) other->GiveToChannel();
    channel->motors = std::make_unique<Connection>(session.address(), Path(name), !session.watches());
    channel->OpenMotors();
  }
  others.push_back(channel);
  return channel;
}

void RobotLink::GiveToChannel() {
  if (motors) {
    Settle();
    if (!session.watches() && !unclaimed) motors->Ask({command::kRelease});
  }
  motors.reset();
  ForgetCommands();
  by_channel = true;
}

void RobotLink::ForgetCommands() {
  commanded_at = -1;
  kept.reset();
  sent.reset();
  carried.reset();
  scans.clear();
}

void RobotLink::Close() {
  ForgetCommands();
  if (motors) motors->Close();
  readers.clear();
  pushers.clear();
}

std::string RobotLink::Path(const std::string& module) const {
  if (module.starts_with(kGroup)) return "/" + robot + "/" + module.substr(kGroup.size());
  const auto known = modules.find(module);
  return "/" + robot + "/" + (known != modules.end() ? known->second : module);
}

bool RobotLink::FindAgain(const std::string& module, Connection& connection) {
  modules = session.ModulesOf(robot);
  const std::string before = connection.module();
  connection.set_module(Path(module));
  return connection.module() != before;
}

void RobotLink::OpenMotors() {
  sent.reset();
  carried.reset();
  motors->Open();
  try {
    if (!session.watches()) {
      try {
        Claim();
      } catch (const Error& e) {
        if (e.code() != kNotPossible && !another)
          throw;  // not possible: a recording is played; reading still works
      }
    }
    if (!attached.empty()) AttachTo(*motors, attached);
    if (session.watches() || unclaimed) session.Note(motors->Ask({command::kGetTime}));
  } catch (...) {
    motors->Close();
    throw;
  }
}

void RobotLink::Claim() {
  unclaimed = true;
  try {
    motors->Ask({command::kClaim});
  } catch (const Error& e) {
    if (e.code() != kOwned) throw;
    if (session.TeamWith(robot) != nullptr) throw Error(kNotPossible, robot + " is driven by its team");
    throw Error(kOwned,
                robot + " cannot be driven: " + e.what() + "; to watch only: connect with watch = true");
  }
  unclaimed = another = false;
  session.Note(motors->Ask({command::kGetTime}));  // a branch may have changed the mode
}

void RobotLink::Settle() {
  if (lost) throw Error(*lost);
  if (!motors->is_open() || (motors->busy() && !sent)) OpenMotors();
  if (!sent || AwaitCommand(kCommandWait_s)) return;
  // No reply: in lockstep it arrives only after the step. Withdraw the command, and keep it.
  if (session.AskMode() == kLockstep) {
    if (!kept) kept = sent;
    OpenMotors();
    return;
  }
  try {
    const Message reply = motors->Receive(kRequestTimeout_s, nullptr);
    sent.reset();
    session.Note(Checked(reply));
  } catch (const Closed& e) {
    Lose(e);
  }
}

bool RobotLink::TakesPart() {
  if (!motors) return false;
  Settle();
  if (unclaimed && !another) {
    try {
      Claim();
    } catch (const Error& e) {
      if (e.code() != kNotPossible && e.code() != kOwned) throw;
      another = !e.text().starts_with(kPlaying);
    }
  }
  return !unclaimed;
}

bool RobotLink::IsFree() {
  return !sent || AwaitCommand(0);
}

void RobotLink::SendStep(int n) {
  sent = kept ? std::move(*kept) : Command{command::kReady, {}};
  sent_at = session.reached();
  kept.reset();
  carried.reset();
  motors->Send(sent->id, sent->joints.empty() ? std::vector<std::int32_t>{n} : sent->joints, sent->data);
}

bool RobotLink::ReleaseIfUnused() {
  if (!motors || commanded || unclaimed || lost) return false;
  Settle();
  motors->Ask({command::kRelease});
  ForgetCommands();
  unclaimed = another = true;
  return true;
}

bool RobotLink::AwaitCommand(double wait_s) {
  const Deadline deadline = After(wait_s);
  while (true) {
    std::optional<Message> reply;
    try {
      reply = motors->TryRead();
    } catch (const Closed& e) {
      Lose(e);
    }
    if (reply) {
      sent.reset();
      session.Fresh(Checked(std::move(*reply)), sent_at);
      return true;
    }
    if (SecondsUntil(deadline) <= 0) return false;
    WaitReadable({motors->fd()}, SecondsUntil(deadline));
  }
}

void RobotLink::Lose(const Closed& closed) {
  ForgetCommands();
  try {
    session.Lose(closed, robot, "sim.robot(\"" + robot + "\")", lost);
  } catch (const Error&) {
    if (lost) session.LoseOthers(*this);
    throw;
  }
}

void RobotLink::Actuate(std::int32_t command, std::vector<double> data, std::vector<std::int32_t> joints) {
  session.RequireDriving();
  if (!motors || has_parts() != !joints.empty())
    throw Error(kNotPossible, robot + (in_team      ? " is driven by its team"
                                       : by_channel ? " is driven through its channel"
                                                    : " has no motors"));
  if (lost) throw Error(*lost);
  if (session.mode() != kLockstep || unclaimed) Settle();
  if (unclaimed) Claim();  // a branch may have ended the playback
  commanded = true;
  if (session.mode() == kLockstep) {
    if (kept) session.CountUnstepped(*this);
    kept = Command{command, std::move(data), std::move(joints)}.After(kept, label());
    return;
  }
  kept.reset();
  session.CountUnstepped(*this);
  sent_at = session.reached();
  try {
    motors->Send(command, joints, data);
  } catch (const Closed& e) {
    Lose(e);
  }
  sent = Command{command, std::move(data), std::move(joints)};
  AwaitCommand(kCommandWait_s);
  commanded_at = session.steps();
}

Message RobotLink::Read(const std::string& module, Request request) {
  session.RequireOpen();
  if (lost && lost->code() == kNoSuchName) throw Error(*lost);
  if (module == actuator && motors && !lost) {
    Settle();
    const std::int64_t since = session.reached();
    try {
      return session.Fresh(motors->Ask(std::move(request), session.polling()), since);
    } catch (const Closed& e) {
      Lose(e);
    }
  }
  std::unique_ptr<Connection>& reader = readers[module];
  // Only a robot's driver may send its messages: that connection needs the driver's name.
  const bool sends = module == "neighbours" && !session.watches();
  if (!reader) reader = std::make_unique<Connection>(session.address(), Path(module), sends);
  try {
    Message reply = session.Ask(*reader, request);
    Require(reply, 0, 0);
    if (StepOf(reply) >= session.reached()) return session.Fresh(std::move(reply), session.reached());
    // Sensors with a rate or a delay return an earlier step: query the present one.
    session.Fresh(session.Ask(*reader, {command::kGetTime}), session.reached());
    return reply;
  } catch (const Error& e) {
    if (e.code() != kNoSuchName || reader->is_open()) throw;
    const std::vector<std::string> names = session.RobotNames();
    if (std::find(names.begin(), names.end(), robot) == names.end()) throw session.NewWorld(kLoad);
    if (FindAgain(module, *reader)) return Read(module, std::move(request));
    const auto who = WhoHas().find(module);
    if (who == WhoHas().end()) throw;
    const std::string& type = who->second;
    throw Error(kNotPossible, robot + " has no module " + module + ", its type has none: " +
                                  (type.empty() ? "" : "a robot of type " + type + " has one, or ") +
                                  "add it to the robot's model.sdf (docs/formats.md)");
  }
}

void RobotLink::AttachTo(Connection& connection, const std::vector<std::string>& types) const {
  std::vector<std::string> names;
  for (const std::string& type : types) names.push_back(Path(type).substr(robot.size() + 2));
  connection.Ask({.command = command::kAttach, .text = Join(names, " ")});
}

void RobotLink::Attach() {
  modules = session.ModulesOf(robot);
  std::vector<std::string> readable;
  for (const char* module : {"motors", "distance", "target", "pose", "compass", "support", "imu", "wrench",
                             "lidar", "contact", "sonar", "infrared", "light", "battery", "odometry"}) {
    if (modules.contains(module)) readable.emplace_back(module);
  }
  for (const std::string& group : session.GroupsOf(robot)) readable.push_back(std::string(kGroup) + group);
  if (readable.empty()) throw Error(kNoSuchName, robot + " has no readings");
  AttachTo(AttachedConnection(readable[0]), readable);
  attached = std::move(readable);
}

Connection& RobotLink::AttachedConnection(const std::string& module) {
  if (motors) {
    Settle();
    return *motors;
  }
  std::unique_ptr<Connection>& reader = readers["attached"];
  if (!reader) reader = std::make_unique<Connection>(session.address(), Path(module), false);
  if (!reader->Alive()) {
    reader->Open();
    if (!attached.empty()) AttachTo(*reader, attached);
  }
  return *reader;
}

Message RobotLink::Sense() {
  session.RequireOpen();
  if (lost && lost->code() == kNoSuchName) throw Error(*lost);
  if (attached.empty()) Attach();
  if (carried) return std::move(*std::exchange(carried, std::nullopt));
  Connection& connection = AttachedConnection(attached[0]);
  const std::int64_t since = session.reached();
  try {
    return session.Fresh(connection.Ask({command::kGetTime}, session.polling()), since);
  } catch (const Closed& e) {
    if (!motors && !e.by_load()) throw;
    Lose(e);
  }
}

}  // namespace coopdyn::client

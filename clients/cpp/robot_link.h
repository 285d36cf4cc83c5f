// SPDX-License-Identifier: MIT
// A robot as a session drives it. One thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clients/cpp/connection.h"
#include "clients/cpp/error.h"

namespace coopdyn::client {

class Session;

/// An actuator command: number and data.
struct Command {
  std::int32_t id = 0;
  std::vector<double> data;
};

/// The connections of a robot, and the command kept for the next step.
struct RobotLink {
  RobotLink(Session& session_of, std::string name) : session(session_of), robot(std::move(name)) {}

  /// An actuator command: kept in lockstep, sent at once otherwise.
  void Actuate(std::int32_t command, std::vector<double> data = {});
  /// A reading of the newest frame. A connection that broke since it was last used is opened again.
  Message Read(const std::string& module, Request request);
  /// The attached readings of the newest frame: the first reading of each module.
  Message Sense();
  /// Opens the connection to the motors, and claims the robot unless the session watches.
  void OpenMotors();
  /// Waits until the motors' connection is free for a request.
  void Settle();
  /// Whether the robot steps with the session. One that was only looked at is taken now if nobody has it.
  bool TakesPart();
  /// Gives up the robot if it was only looked at, so that a team can have it.
  bool LetGo();
  /// The daemon closed the connection to the motors.
  [[noreturn]] void Lose(const Closed& closed);
  bool is_ours() const { return motors && motors->is_open() && !unclaimed && !lost; }
  void ForgetCommands();
  void Close();

  Session& session;
  const std::string robot;
  std::unique_ptr<Connection> motors;                          // null: it has no motors, or `in_team`
  std::map<std::string, std::unique_ptr<Connection>> readers;  // by module
  std::map<std::string, std::unique_ptr<Connection>> pushers;  // subscriptions, by module
  std::optional<Command> kept;                                 // for the next step
  std::optional<Command> sent;                                 // its reply has not come yet
  std::int64_t sent_at = 0;                                    // the newest step when it was sent
  int unstepped = 0;                                           // commands since the last step
  std::int64_t unstepped_since = 0;                            // the step of the first of them
  std::optional<Error> lost;                                   // why it is not ours any more
  bool commanded = false;                                      // by this program, ever
  bool unclaimed = false;  // only looked at: when it was last asked for a recording was played, or
  bool another = false;    // another had it; then not asked for again before it is commanded
  bool in_team = false;    // a team of ours drives it: for reading only
  std::vector<std::string> attached;
  std::optional<Message> carried;  // the readings that came with the reply to the last step
  double labels_step = -1;         // of ids and colours of the targets
  Deadline labels_until{};
  std::vector<std::int32_t> ids;
  std::vector<std::string> colours;

 private:
  void Claim();
  bool AwaitCommand();
  void Attach();
  Connection& AttachedConnection(const std::string& module);
};

}  // namespace coopdyn::client

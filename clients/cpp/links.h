// SPDX-License-Identifier: MIT
// Robots and teams as a session drives them. One thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clients/cpp/connection.h"
#include "clients/cpp/error.h"
#include "protocol/message.h"

namespace coopdyn::client {

class Session;

/// An actuator command. That of joints, muscles and thrusters names these, as many values for each.
struct Command {
  std::int32_t id = 0;
  std::vector<double> data = {};
  std::vector<std::int32_t> joints = {};

  /// What one step of `whose` is to do that was told `kept` before, this now: what both say of a joint, the
  /// last wins. Throws Error 5 if one step cannot do both.
  Command After(const std::optional<Command>& kept, const std::string& whose) const;
};

// Types of modules.
inline constexpr const char *kMotors = "motors", *kJoints = "joints", *kChannel = "channel";
/// Before the name of a group of joints, among types of modules.
inline constexpr std::string_view kGroup = "joints/";

/// What get_scan_geometry tells of a lidar [rad, m].
struct ScanGeometry {
  double first = 0, increment = 0, min_range = 0, max_range = 0;
  std::size_t rows = 0, columns = 0;
  double low = 0, step = 0;
};

/// The connections to an actuator module of a robot, and the command kept for the next step. The first of a
/// robot, its motors if it has any, has the robot's other connections, too.
struct RobotLink {
  RobotLink(Session& session_of, std::string name, std::string actuator_of = kMotors,
            std::string type_of = kMotors)
      : session(session_of),
        robot(std::move(name)),
        actuator(std::move(actuator_of)),
        type(std::move(type_of)) {}

  /// Opens the connections to all actuators of the robot, `others` included, and claims them unless the
  /// session watches.
  void Take();
  /// The link to the robot's channel, which drives all that its other actuators drive: these are given up.
  std::shared_ptr<RobotLink> TakeChannel(const std::string& name);
  /// An actuator command: kept in lockstep, sent at once otherwise.
  void Actuate(std::int32_t command, std::vector<double> data = {}, std::vector<std::int32_t> joints = {});
  /// A reading of the newest frame. A connection that broke since it was last used is opened again.
  Message Read(const std::string& module, Request request);
  /// The attached readings of the newest frame: the first reading of each module.
  Message Sense();
  /// Of the module of this type or name: "/robot1/motors".
  std::string Path(const std::string& module) const;
  /// After error 10: a model may call its motors module `legs`. True if the connection is to another module
  /// now.
  bool FindAgain(const std::string& module, Connection& connection);
  /// Opens the connection to the actuator, and claims it unless the session watches.
  void OpenMotors();
  /// Waits until the motors' connection is free for a request.
  void Settle();
  /// Whether the robot steps with the session. One that was only looked at is taken now if nobody has it.
  bool TakesPart();
  /// The reply to the last command has come.
  bool IsFree();
  /// What was kept, or `ready`, for n steps.
  void SendStep(int n);
  /// Gives up the robot if it was only looked at, so that a team can have it.
  bool LetGo();
  /// The daemon closed the connection to the motors.
  [[noreturn]] void Lose(const Closed& closed);
  /// Its commands stand for one step, and say of what: a group of joints, muscles, thrusters.
  bool has_parts() const { return type != kMotors; }
  /// In errors: of joints "robot1/arm".
  std::string label() const { return has_parts() ? robot + "/" + actuator : robot; }
  bool is_ours() const { return motors && motors->is_open() && !unclaimed && !lost; }
  void ForgetCommands();
  void Close();

  Session& session;
  const std::string robot;
  std::string actuator;                                        // "motors", or the name of a module
  std::string type;                                            // of that module
  std::vector<std::shared_ptr<RobotLink>> others;              // the robot's further actuators
  std::unique_ptr<Connection> motors;                          // null: it has no actuator, or `in_team`
  std::map<std::string, std::unique_ptr<Connection>> readers;  // by module
  std::map<std::string, std::unique_ptr<Connection>> pushers;  // subscriptions, by module
  std::map<std::string, std::string> modules;                  // names by type, once they were needed
  std::optional<Command> kept;                                 // for the next step
  std::optional<Command> sent;                                 // its reply has not come yet
  std::optional<Command> last;        // what it is told when the session is closed, if not to stop or hold
  std::int64_t sent_at = 0;           // the newest step when it was sent
  std::int64_t commanded_at = -1;     // the newest when a command was answered at once
  int unstepped = 0;                  // commands since the last step
  std::int64_t unstepped_since = 0;   // the step of the first of them
  std::optional<Error> lost;          // why it is not ours any more
  bool commanded = false;             // by this program, ever
  bool unclaimed = false;             // only looked at: when it was last asked for a recording was played, or
  bool another = false;               // another had it; then not asked for again before it is commanded
  bool beside = false;                // takes no part in lockstep: no step of ours waits for its reply
  bool in_team = false;               // a team of ours drives it: for reading only
  bool by_channel = false;            // the robot's channel drives it
  std::vector<std::string> attached;  // types of modules, in the order of their readings
  std::optional<Message> carried;     // the readings that came with the reply to the last step
  double labels_step = -1;            // of ids and colours of the targets
  Deadline labels_until{};
  std::vector<std::int32_t> ids;
  std::vector<std::string> colours;
  std::map<std::string, ScanGeometry> scans;  // by module, once they were needed

 private:
  void Claim();
  /// Lets its channel have it.
  void GiveToChannel();
  bool AwaitCommand(double wait_s);
  /// Has every reply to get_time bring the readings of these modules.
  void AttachTo(Connection& connection, const std::vector<std::string>& types) const;
  void Attach();
  Connection& AttachedConnection(const std::string& module);
};

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
struct TeamRequest {
  TeamLink* team = nullptr;
  std::string text;  // its words, or empty
  std::span<const double> values;
};

}  // namespace coopdyn::client

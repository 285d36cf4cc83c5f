// SPDX-License-Identifier: MIT
// A session's links to the robots and teams that it drives. One thread.
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

/// An actuator command. Commands to joints, muscles and thrusters name them, with one value for each.
struct Command {
  std::int32_t id = 0;
  std::vector<double> data = {};
  std::vector<std::int32_t> joints = {};

  /// Merges this command with `kept`, an earlier one for the same step of `whose`. Where both name a joint,
  /// this one wins. Throws Error 5 if one step cannot do both.
  Command After(const std::optional<Command>& kept, const std::string& whose) const;
};

// Types of modules.
inline constexpr const char *kMotors = "motors", *kJoints = "joints", *kChannel = "channel";
/// Prefix of the name of a group of joints where types of modules are expected.
inline constexpr std::string_view kGroup = "joints/";

/// A lidar's reply to get_scan_geometry [rad, m].
struct ScanGeometry {
  double first = 0, increment = 0, min_range = 0, max_range = 0;
  std::size_t rows = 0, columns = 0;
  double low = 0, step = 0;
};

/// The connections to an actuator module of a robot, and the command kept for the next step. A robot's first
/// link, its motors if it has any, also owns the robot's other connections.
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
  /// Returns the link to the robot's channel, and gives up the robot's other actuators, which the channel now
  /// drives.
  std::shared_ptr<RobotLink> TakeChannel(const std::string& name);
  /// In lockstep keeps an actuator command, otherwise sends it.
  void Actuate(std::int32_t command, std::vector<double> data = {}, std::vector<std::int32_t> joints = {});
  /// Returns a reading of the newest frame. Reopens a connection that broke since its last use.
  Message Read(const std::string& module, Request request);
  /// Returns the attached readings of the newest frame: the first reading of each module.
  Message Sense();
  /// The path of the module of this type or name, e.g. "/robot1/motors".
  std::string Path(const std::string& module) const;
  /// After error 10: looks up the module's name by its type, as a model may call its motors `legs`. True if
  /// the connection's module has changed.
  bool FindAgain(const std::string& module, Connection& connection);
  /// Opens the connection to the actuator, and claims it unless the session watches.
  void OpenMotors();
  /// Waits until the motors' connection is free for a request.
  void Settle();
  /// Whether the robot steps with the session. Claims an unclaimed robot if it is free.
  bool TakesPart();
  /// True if no reply to a command is pending.
  bool IsFree();
  /// Sends the kept command, or `ready`, for n steps.
  void SendStep(int n);
  /// Releases the robot for a team if this program never commanded it. True if released.
  bool ReleaseIfUnused();
  /// The daemon closed the connection to the motors: throws.
  [[noreturn]] void Lose(const Closed& closed);
  /// True for joints, muscles and thrusters: a command lasts one step and names the parts.
  bool has_parts() const { return type != kMotors; }
  /// The name in errors; for joints "robot1/arm".
  std::string label() const { return has_parts() ? robot + "/" + actuator : robot; }
  bool is_ours() const { return motors && motors->is_open() && !unclaimed && !lost; }
  void ForgetCommands();
  void Close();

  Session& session;
  const std::string robot;
  std::string actuator;                                        // "motors", or the name of a module
  std::string type;                                            // of `actuator`
  std::vector<std::shared_ptr<RobotLink>> others;              // the robot's further actuators
  std::unique_ptr<Connection> motors;                          // null: no actuator, or `in_team`
  std::map<std::string, std::unique_ptr<Connection>> readers;  // by module
  std::map<std::string, std::unique_ptr<Connection>> pushers;  // subscriptions, by module
  std::map<std::string, std::string> modules;                  // names by type; queried when first needed
  std::optional<Command> kept;                                 // for the next step
  std::optional<Command> sent;                                 // reply pending
  std::optional<Command> last;        // sent when the session closes, instead of stop or hold
  std::int64_t sent_at = 0;           // newest step when `sent` was sent
  std::int64_t commanded_at = -1;     // newest step when a command was answered immediately
  int unstepped = 0;                  // commands since the last step
  std::int64_t unstepped_since = 0;   // the step of the first of them
  std::optional<Error> lost;          // why this session no longer drives it
  bool commanded = false;             // by this program, ever
  bool unclaimed = false;             // read-only: the last claim failed, in a playback or because
  bool another = false;               // another client had it; then claimed again only by a command
  bool beside = false;                // no participant in lockstep: steps do not wait for its reply
  bool in_team = false;               // one of our teams drives it; for reading only
  bool by_channel = false;            // the robot's channel drives it
  std::vector<std::string> attached;  // types of modules, in the order of their readings
  std::optional<Message> carried;     // readings in the reply to the last step
  double labels_step = -1;            // step of the targets' ids and colours
  Deadline labels_until{};
  std::vector<std::int32_t> ids;
  std::vector<std::string> colours;
  std::map<std::string, ScanGeometry> scans;  // by module; queried when first needed

 private:
  void Claim();
  /// Releases the actuator to the robot's channel.
  void GiveToChannel();
  bool AwaitCommand(double wait_s);
  /// Attaches the readings of these modules to every reply to get_time.
  void AttachTo(Connection& connection, const std::vector<std::string>& types) const;
  void Attach();
  Connection& AttachedConnection(const std::string& module);
};

/// A connection to /swarm that owns all robots of the team. While a recording is played nobody can own
/// robots, and the team only reads.
struct TeamLink {
  /// `text`: the names as given by the program. `number` distinguishes the teams of one client.
  TeamLink(Session& session_of, std::string text_of, int number_of);

  /// Opens the connection and claims the robots. Throws Error 6 if another client owns one.
  void Open();
  /// Makes the connection ready for a request; queries the team's members if they may have changed.
  void Settle();
  /// Claims the robots if a branch has ended the playback. Throws Error 5 while a recording is played.
  void Own();
  /// Chooses the readings.
  void Select(const std::string& words, int nearest);
  /// Sends a request that is answered immediately.
  Message Ask(std::int32_t command, std::vector<std::int32_t> params = {});
  /// Returns the readings of the newest step.
  Message Read();
  /// Queries the members and the columns of a row again, after robots or targets were added or removed.
  void Refresh();
  /// Releases the robots; stops them before if `stop`.
  void GiveUp(bool stop);
  /// The daemon closed the connection: throws.
  [[noreturn]] void Lose(const Closed& closed);
  /// Throws an error that says who owns the robot named in `owned`.
  [[noreturn]] void ThrowOwned(const Error& owned) const;
  bool Has(const std::string& robot) const;

  /// The name in errors.
  std::string label() const;
  std::string TakeAgain() const;

  Session& session;
  const std::string text;
  const int number;
  Connection connection;
  std::string selected = "pose distances";
  int neighbours = 8;
  std::vector<std::string> names;
  std::vector<std::int32_t> ids;      // one per name
  std::vector<std::string> readings;  // in the order of a row
  std::vector<std::size_t> columns;   // of each reading
  bool stale = false;                 // the members must be queried again
  std::optional<Message> reply;       // to the last step
  std::vector<std::string> gone;      // robots lost since the team's last step
  std::optional<Error> lost;          // why this session no longer drives the team
  std::string playing;  // error text if a recording is played, and the team only reads; else empty

 private:
  bool one_word() const { return !text.empty() && text.find(' ') == std::string::npos; }
  Message Claim();
  /// Stores the team's members from a reply. Throws if the team has lost all its robots.
  void Name(Message reply);
  /// Claims the robots; while a recording is played, only looks them up.
  void Take();
  /// Looks up the members in a played recording: `claim` has checked their names, but returns no ids.
  void Find();
  /// The ids of the n robots in ascending order, with gaps where robots have been removed.
  std::vector<std::int32_t> KnownIds(std::size_t n);
};

/// A team's command for a step; the session's other teams keep their speeds.
struct TeamRequest {
  TeamLink* team = nullptr;
  std::string text;  // of step_all; may be empty
  std::span<const double> values;
};

}  // namespace coopdyn::client

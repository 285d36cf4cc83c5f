// SPDX-License-Identifier: MIT
// The connections of one connect(), and the client's knowledge of the world. Shared by a Simulation and its
// robots. One thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clients/cpp/address.h"
#include "clients/cpp/connection.h"
#include "clients/cpp/error.h"
#include "clients/cpp/json.h"
#include "clients/cpp/links.h"

namespace coopdyn::client {

inline constexpr double kNoticeAfter_s = 2;  ///< a longer wait reports once whom it waits for
inline constexpr const char* kSimulation = "/simulation";

class Session {
 public:
  Session(Address address, bool watch) : address_(std::move(address)), watch_(watch) {}

  const Address& address() const { return address_; }
  bool watches() const { return watch_; }
  double time() const { return time_; }
  std::int64_t steps() const { return steps_; }
  /// The newest step of this world reported by a reading, command or step; 0 again after a reset.
  std::int64_t reached() const { return reached_; }
  int mode() const { return mode_; }
  void set_mode(int mode) { mode_ = mode; }
  /// The polling before a wait. Polls for COOPDYN_SPIN [µs]; by default 50 µs in lockstep with up to four
  /// robots, else not at all.
  Polling* polling();
  void RequireOpen() const;
  void RequireDriving() const;

  // Requests that are answered immediately.
  /// Sends a request to a module of the whole simulation.
  Message RequestGlobal(const std::string& module, Request request);
  Message Control(Request request) { return RequestGlobal(kSimulation, std::move(request)); }
  int AskMode();
  Json Status();
  /// The names of all robots, in the order of the scenario.
  std::vector<std::string> RobotNames();
  /// The names of a robot's modules by type: among several of a type, the one named like it, else the first.
  std::map<std::string, std::string> ModulesOf(const std::string& robot);
  /// The names and types of a robot's actuator modules, in its order.
  std::vector<std::pair<std::string, std::string>> ActuatorsOf(const std::string& robot);
  /// Adds a link that was taken later; steps then include it.
  void Add(std::shared_ptr<RobotLink> link) { links_.push_back(std::move(link)); }
  /// The names of a robot's groups of joints.
  std::vector<std::string> GroupsOf(const std::string& robot);
  /// A module's description of its commands.
  Json Describe(const std::string& module);
  /// Sends a request; reopens a connection that broke since its last use.
  Message Ask(Connection& connection, const Request& request);
  /// Sends a request to any module. In lockstep, the reply to an actuator command arrives after the step.
  Message Call(const std::string& module, Request request);

  // Driving.
  /// The link to `robot`, opened and (unless watching) claimed.
  std::shared_ptr<RobotLink> Drive(const std::string& robot);
  /// The team of these names, opened and claimed.
  std::shared_ptr<TeamLink> DriveTeam(const std::string& text);
  /// The session's team that has the robot, other than `but`; null: none.
  const TeamLink* TeamWith(const std::string& robot, const TeamLink* but = nullptr) const;
  /// Marks unclaimed robots as members of a team.
  void GiveToTeam(const std::vector<std::string>& robots);
  void CloseTeam(TeamLink& team, bool stop);
  /// Runs n steps: sends the kept command, or `ready`, for every robot and team of this session.
  void Step(int n, double timeout_s, const TeamRequest& command = {});
  /// Another client drives the robot of `lost`: marks the robot's other actuators as lost, too.
  void LoseOthers(const RobotLink& lost);
  /// The kept commands of single robots; Keep() restores them if a step was refused.
  std::vector<std::optional<Command>> Kept() const;
  void Keep(std::vector<std::optional<Command>> kept);
  /// Reports once that the program never calls step(), unless time passes in another way, e.g. by sleeping.
  void CountUnstepped(RobotLink& link);
  /// The daemon closed the connection of `label`: throws the error, and stores it in `lost` if the connection
  /// must not be reopened.
  [[noreturn]] void Lose(const Closed& closed, const std::string& label, const std::string& take_again,
                         std::optional<Error>& lost);
  /// One line that says what the world waits for; with `held_up`, empty if steps still run. With `in_step`,
  /// throws WorldReset if the world was reset or loaded meanwhile.
  std::string DescribeWait(bool held_up = false, bool in_step = false) const;
  /// Sends `stop` to the robots that this session drives, then closes everything. Does not wait for a step.
  void Close();
  /// Hands over the daemon that launch() started; it exits with this session.
  void set_daemon(std::shared_ptr<void> daemon) { daemon_ = std::move(daemon); }

  // The world.
  /// Stores the reply's time and mode.
  const Message& Note(const Message& reply);
  /// Like Note(), for a request sent when the world had reached step `since`; throws WorldReset if the reply
  /// belongs to an earlier step, except in a playback, where time may go back.
  Message Fresh(Message reply, std::int64_t since);
  /// The scenario of the present world; a load changes it.
  void set_scenario(std::string name) { scenario_ = std::move(name); }
  /// After a reset.
  void OnReset();
  void ForgetCommands();
  /// After a load: returns those of this session's robots that the new scenario lacks.
  std::vector<std::string> Loaded();
  /// After this session's restore or branch: the world continues from another state, possibly of another
  /// scenario.
  void OnRestored();
  /// Another client has reset the world, or (if `word` is kLoad, or the scenario differs) loaded a scenario:
  /// discards the state of the old world and returns the error to throw.
  WorldReset NewWorld(const std::string& word = "");
  /// True if `status` belongs to a world that another client has reset or loaded.
  bool IsNew(const Json& status) const;
  /// After an error of a team: throws WorldReset if a scenario was loaded.
  void ThrowIfLoaded(const Error& error);

 private:
  std::shared_ptr<void> daemon_;  // first member: destroyed after all connections
  struct Waiting {
    Connection* connection;
    RobotLink* link = nullptr;  // both null: /simulation, or a raw message
    TeamLink* team = nullptr;
    bool done = false;
  };
  /// The replies to one step.
  struct Replies {
    Message last;
    std::int64_t earliest;  // step
  };

  /// The status of all robots.
  std::vector<Json> Robots();
  /// Releases a robot for a team if this program never commanded it. True if released.
  bool ReleaseIfUnused(const std::string& robot);
  Connection& Of(const std::string& module);
  void Resume(std::int64_t step, std::int64_t since);
  std::vector<Waiting> WhoSteps(const TeamRequest& command);
  void StoreReply(Waiting& w, Message reply, Replies& replies);
  bool StoreReplies(std::vector<Waiting>& waiting, bool all, std::vector<int>& missing, Replies& replies);
  Replies Collect(std::vector<Waiting>& waiting, double timeout_s);
  void CatchUp(std::vector<Waiting>& waiting);
  void GiveUp(std::vector<Waiting>& waiting, const Error& cause);
  Json FreshStatus() const;

  const Address address_;
  const bool watch_;
  std::map<std::string, Connection> modules_;  // of the whole simulation
  /// Names and types of actuator modules by robot; empty: not queried yet.
  std::map<std::string, std::vector<std::pair<std::string, std::string>>> actuators_;
  std::vector<std::shared_ptr<RobotLink>> links_;
  std::vector<std::shared_ptr<TeamLink>> teams_;
  int mode_ = 0;
  Polling polling_;
  double time_ = 0;
  std::int64_t steps_ = 0, reached_ = 0;
  std::string scenario_;  // name of the present world's scenario
  bool warned_to_step_ = false;
  bool closed_ = false;
};

}  // namespace coopdyn::client

// SPDX-License-Identifier: MIT
// What a simulation and its robots share: the connections of one connect(), and what is known of the world.
// One thread.
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

inline constexpr double kNoticeAfter_s = 2;  ///< a wait that is longer says once whom for
inline constexpr const char* kSimulation = "/simulation";

class Session {
 public:
  Session(Address address, bool watch) : address_(std::move(address)), watch_(watch) {}

  const Address& address() const { return address_; }
  bool watches() const { return watch_; }
  double time() const { return time_; }
  std::int64_t steps() const { return steps_; }
  /// The newest step of this world that a reading, command or step has told; 0 again after a reset.
  std::int64_t reached() const { return reached_; }
  int mode() const { return mode_; }
  void set_mode(int mode) { mode_ = mode; }
  /// The polling before a wait: for as long as COOPDYN_SPIN [µs] says, by default 50 µs in lockstep with up
  /// to four robots.
  Polling* polling();
  void RequireOpen() const;
  void RequireDriving() const;

  // Requests that are answered at once.
  /// To a module of the whole simulation.
  Message Tell(const std::string& module, Request request);
  Message Control(Request request) { return Tell(kSimulation, std::move(request)); }
  int AskMode();
  Json Status();
  /// The names of all robots, in the order of the scenario.
  std::vector<std::string> RobotNames();
  /// The names of a robot's modules by type: of several of a type the one named like it, else the first.
  std::map<std::string, std::string> ModulesOf(const std::string& robot);
  /// The names and types of a robot's actuator modules, in its order.
  std::vector<std::pair<std::string, std::string>> ActuatorsOf(const std::string& robot);
  /// Steps with a link that was taken later.
  void Add(std::shared_ptr<RobotLink> link) { links_.push_back(std::move(link)); }
  /// The names of a robot's groups of joints.
  std::vector<std::string> GroupsOf(const std::string& robot);
  /// What a module says about its commands.
  Json Describe(const std::string& module);
  /// On a connection that is opened again if it broke since it was last used.
  Message Ask(Connection& connection, const Request& request);
  /// To any module; an actuator command is answered after the step in lockstep.
  Message Call(const std::string& module, Request request);

  // Driving.
  /// The link to `robot`, opened and (unless watching) claimed.
  std::shared_ptr<RobotLink> Drive(const std::string& robot);
  /// The team of these names, opened and claimed.
  std::shared_ptr<TeamLink> DriveTeam(const std::string& text);
  /// The team of ours that has the robot, unless it is `but`; null: none.
  const TeamLink* TeamWith(const std::string& robot, const TeamLink* but = nullptr) const;
  /// Robots that were only looked at are a team's from now on.
  void GiveToTeam(const std::vector<std::string>& robots);
  void CloseTeam(TeamLink& team, bool stop);
  /// Steps with what was kept, or `ready`, for every robot and every team of this session.
  void Step(int n, double timeout_s, const TeamRequest& command = {});
  /// The robot of `lost` is another's: its other actuators are not ours any more, either.
  void LoseOthers(const RobotLink& lost);
  /// What single robots were told for the next step; put back if it was refused.
  std::vector<std::optional<Command>> Kept() const;
  void Keep(std::vector<std::optional<Command>> kept);
  /// Says once that the program never calls step(); not if it lets time go by in another way, as by sleeping.
  void CountUnstepped(RobotLink& link);
  /// The daemon closed the connection of `label`: throws the error, kept in `lost` if it must not be opened
  /// again.
  [[noreturn]] void Lose(const Closed& closed, const std::string& label, const std::string& take_again,
                         std::optional<Error>& lost);
  /// One line that says what the world waits for; with `held_up` empty if its steps go on. With `in_step` it
  /// throws what the step's reply would say if the world is another by now.
  std::string Whom(bool held_up = false, bool in_step = false) const;
  /// Writes `stop` to the robots that this session drives, then closes everything. Does not wait.
  void Close();
  /// A daemon that launch() has started; it ends with this session.
  void set_daemon(std::shared_ptr<void> daemon) { daemon_ = std::move(daemon); }

  // The world.
  /// Takes over time and mode.
  const Message& Note(const Message& reply);
  /// Note() of a reply to a request that was sent when the world had reached step `since`; throws WorldReset
  /// if the reply is of an earlier step. In a recording that is played time may go back.
  Message Fresh(Message reply, std::int64_t since);
  /// The scenario of a new world; a load brings another.
  void set_scenario(std::string name) { scenario_ = std::move(name); }
  /// After a reset.
  void StartedAnew();
  void ForgetCommands();
  /// After a load: returns the robots of ours that are not there any more.
  std::vector<std::string> Loaded();
  /// After a restore or branch of ours: the world goes on from another state, maybe of another scenario.
  void Jumped();
  /// Somebody has reset the world, or (if `word` is kLoad, or the scenario is another one) loaded a scenario:
  /// forgets what belongs to the old world, and says so.
  WorldReset NewWorld(const std::string& word = "");
  /// The status is of a world that somebody else has reset or loaded.
  bool IsNew(const Json& status) const;
  /// After an error of a team: throws WorldReset if a scenario was loaded.
  void ThrowIfLoaded(const Error& error);

 private:
  std::shared_ptr<void> daemon_;  // first: it ends when all connections are closed
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

  /// What the status tells of all robots.
  std::vector<Json> Robots();
  /// Gives up a robot that was only looked at, so that a team can have it.
  bool LetGo(const std::string& robot);
  Connection& Of(const std::string& module);
  void Resume(std::int64_t step, std::int64_t since);
  std::vector<Waiting> WhoSteps(const TeamRequest& command);
  void TakeIn(Waiting& w, Message reply, Replies& replies);
  bool TakeAllIn(std::vector<Waiting>& waiting, bool all, std::vector<int>& missing, Replies& replies);
  Replies Collect(std::vector<Waiting>& waiting, double timeout_s);
  void CatchUp(std::vector<Waiting>& waiting);
  void GiveUp(std::vector<Waiting>& waiting, const Error& cause);
  Json FreshStatus() const;

  const Address address_;
  const bool watch_;
  std::map<std::string, Connection> modules_;  // of the whole simulation
  /// Names and types of actuator modules by robot; empty: not asked yet.
  std::map<std::string, std::vector<std::pair<std::string, std::string>>> actuators_;
  std::vector<std::shared_ptr<RobotLink>> links_;
  std::vector<std::shared_ptr<TeamLink>> teams_;
  int mode_ = 0;
  Polling polling_;
  double time_ = 0;
  std::int64_t steps_ = 0, reached_ = 0;
  std::string scenario_;  // its name, as it was when this world began
  bool warned_to_step_ = false;
  bool closed_ = false;
};

}  // namespace coopdyn::client

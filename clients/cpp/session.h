// SPDX-License-Identifier: MIT
// What a simulation and its robots share: the connections of one connect(), and the rules of driving. One
// thread.
#pragma once

#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clients/cpp/address.h"
#include "clients/cpp/connection.h"
#include "clients/cpp/error.h"
#include "clients/cpp/json.h"
#include "clients/cpp/team_link.h"

namespace coopdyn::client {

inline constexpr double kNoticeAfter_s = 2;  ///< a wait that is longer says once whom for

/// An actuator command: number and data.
struct Command {
  std::int32_t id = 0;
  std::vector<double> data;
};

/// A robot as this client drives it: its connections, and the command kept for the next step.
struct Link {
  std::string robot;
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

  void ForgetCommands();
  void Close();
};

class Session {
 public:
  Session(Address address, bool watch);

  const Address& address() const { return address_; }
  double time() const { return time_; }
  std::int64_t steps() const { return steps_; }
  bool closed() const { return closed_; }
  void set_mode(int mode) { mode_ = mode; }
  /// Microseconds of polling before a wait, from COOPDYN_SPIN; by default 50 in lockstep with up to four
  /// robots.
  double spin_s() const;

  /// Opens the connection to /simulation.
  void Open() { simulation_.Open(); }
  void RequireOpen() const;
  /// A request to /simulation.
  Message Control(std::int32_t command, std::vector<std::int32_t> params = {}, std::vector<double> data = {},
                  std::string text = "", double timeout_s = 10);
  /// A request to another module of the whole simulation.
  Message Tell(const std::string& module, std::int32_t command, std::vector<std::int32_t> params = {},
               std::vector<double> data = {}, std::string text = "", double timeout_s = 10);
  Json Status();
  /// The scenario of a new world; a load brings another.
  void set_scenario(std::string name) { scenario_ = std::move(name); }
  /// After a raw message that may have been a reset.
  void ForgetSteps() { reached_ = 0; }
  /// The names of all robots, in the order of the scenario.
  std::vector<std::string> RobotNames();
  /// A reading of the newest frame. A connection that broke since it was last used is opened again.
  Message Read(Link& link, const std::string& module, std::int32_t command,
               std::vector<std::int32_t> params = {}, std::string text = "", std::vector<double> data = {});
  /// Broadcasts a message of the robot.
  void Send(Link& link, const std::vector<double>& values);
  /// What a module says about its commands.
  Json Describe(const std::string& module);
  Message Call(const std::string& module, std::int32_t command, std::vector<std::int32_t> params,
               std::vector<double> data, std::string text, double timeout_s);

  /// The link to `robot`, opened and (unless watching) claimed.
  std::shared_ptr<Link> Drive(const std::string& robot);
  /// An actuator command: kept in lockstep, sent at once otherwise.
  void Actuate(Link& link, std::int32_t command, std::vector<double> data);
  /// Steps with what was kept, or `ready`, for every robot and every team of this session.
  void Step(int n, double timeout_s, const TeamCommand& command = {});

  /// The team of these names, opened and claimed.
  std::shared_ptr<TeamLink> DriveTeam(const std::string& text);
  /// The connection of a team, free for a request.
  Connection& SettleTeam(TeamLink& team);
  /// One step of the world, in which a team does what the command says.
  Message StepTeam(const TeamCommand& command, double timeout_s);
  /// What single robots were told for the next step; put back if it was refused.
  std::vector<std::optional<Command>> Kept() const;
  void Keep(std::vector<std::optional<Command>> kept);
  /// A request that is answered at once.
  Message AskTeam(TeamLink& team, std::int32_t command, std::vector<std::int32_t> params = {});
  /// The readings of the newest step.
  Message ReadTeam(TeamLink& team);
  /// Throws Error 5 while a recording is played; a branch may have gone on live from there.
  void OwnTeam(TeamLink& team);
  void Select(TeamLink& team, const std::string& words, int neighbours);
  /// What of a row changes if robots or targets have come or gone; asked anew.
  void RefreshTeam(TeamLink& team);
  /// Gives the robots up, after stopping them if wished.
  void CloseTeam(TeamLink& team, bool stop);

  /// Attaches the first readings of all modules of the robot to its connection.
  void Attach(Link& link);
  /// The attached readings of the newest frame.
  Message Sense(Link& link);
  /// After a reset or load.
  void StartedAnew();
  void ForgetCommands();
  /// After a load: returns the robots of ours that are not there any more.
  std::vector<std::string> Loaded();
  /// Somebody has reset the world, or (if `word` is kLoad, or the scenario is another one) loaded a scenario:
  /// forgets what belongs to the old world, and says so.
  WorldReset NewWorld(const std::string& word = "");
  /// After a restore or branch of ours: the world goes on from another state, maybe of another scenario.
  void Jumped();
  /// One line that says what the world waits for; with `held_up` empty if its steps go on.
  std::string Whom(bool held_up = false) const;
  /// Writes `stop` to the robots that this session drives, then closes everything. Does not wait.
  void Close();

 private:
  struct Waiting {
    Connection* connection;
    Link* link;  // null: /simulation, a raw message, or a team
    TeamLink* team = nullptr;
    bool done = false;
  };

  const Message& Note(const Message& reply);
  /// Note() of a reply to a request that was sent when the world had reached step `since`.
  const Message& Fresh(const Message& reply, std::int64_t since);
  /// A request that was sent when the world had reached step `since` was answered with `step`: throws
  /// WorldReset if that is earlier. In a recording that is played time may go back.
  void GoOn(std::int64_t step, std::int64_t since);
  /// After an error of a team: throws WorldReset if a scenario was loaded.
  void ThrowIfLoaded(const Error& error);
  /// Says once that the program never calls step(); not if it lets time go by in another way, as by sleeping.
  void CountUnstepped(Link& link);
  Message Ask(Connection& connection, std::int32_t command, std::vector<std::int32_t> params,
              std::string text, std::vector<double> data = {});
  void OpenMotors(Link& link);
  void Claim(Link& link);
  void Settle(Link& link);
  /// Whether the robot steps with this session. One that was only looked at is taken now if nobody has it.
  bool TakesPart(Link& link);
  /// Gives up a robot of ours that was only looked at, so that a team can have it.
  bool LetGo(const std::string& robot);
  bool HasTeamWith(const std::string& robot) const;
  bool AwaitCommand(Link& link);
  [[noreturn]] void Lose(Link& link, const Closed& closed);
  /// The daemon closed the connection of `label`: throws the error, kept in `lost` if it must not be opened
  /// again.
  [[noreturn]] void Lose(const Closed& closed, const std::string& label, const std::string& take_again,
                         std::optional<Error>& lost);
  void OpenTeam(TeamLink& team);
  Message Claim(const TeamLink& team);
  /// Takes over who is in the team. One that has lost all its robots is none any more: throws.
  void NameTeam(TeamLink& team, Message reply);
  /// Makes the robots ours; while a recording is played only finds out which they are.
  void TakeTeam(TeamLink& team);
  /// Who is meant, in a recording that is played: `claim` has found the names good, but tells no ids.
  void FindTeam(TeamLink& team);
  [[noreturn]] void NotOurs(const TeamLink& team, const Error& owned) const;
  Connection& AttachedConnection(Link& link, const std::vector<std::string>& modules);
  static std::string Label(const Waiting& w);
  void TakeIn(Waiting& w, Message reply, Message& last);
  bool TakeAllIn(std::vector<Waiting>& waiting, bool all, std::vector<int>& missing, Message& last);
  Message Collect(std::vector<Waiting>& waiting, double timeout_s);
  void GiveUp(std::vector<Waiting>& waiting, const std::exception_ptr& cause);
  void CatchUp(std::vector<Waiting>& waiting);
  Json FreshStatus() const;

  Address address_;
  bool watch_;
  Connection simulation_;
  std::vector<std::shared_ptr<Link>> links_;
  std::vector<std::shared_ptr<TeamLink>> teams_;
  std::map<std::string, std::unique_ptr<Connection>> others_;  // of Call()
  int mode_ = 0;
  double time_ = 0;
  std::int64_t steps_ = 0;
  /// The newest step of this world that a reading, command or step has told; 0 again after a reset.
  std::int64_t reached_ = 0;
  std::int64_t earliest_ = 0;  // of the replies to the present step
  std::string scenario_;       // its name, as it was when this world began
  bool told_to_step_ = false;
  bool closed_ = false;
};

}  // namespace coopdyn::client

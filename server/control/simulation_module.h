// SPDX-License-Identifier: MIT
// /simulation: how the run stands and goes on. Free of sockets. The control thread only.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/control/global_module.h"
#include "server/model/readers.h"
#include "server/naming/name_table.h"
#include "server/state/run_control.h"
#include "server/state/run_input.h"

namespace coopdyn {

/// The states that `save` has kept, by name.
class SavedStates {
 public:
  static constexpr std::size_t kMaxStates = 100;
  static constexpr std::size_t kMaxName = 63;
  /// The name of the start, which is always there.
  static constexpr std::string_view kStart = "start";

  /// Why nothing can be kept under `name`; empty if it can.
  std::string Objection(const std::string& name) const;
  /// @pre no Objection(). Replaces what is called the same.
  void Keep(const std::string& name, SavedStatePtr state);
  /// Null if there is none of that name.
  SavedStatePtr Find(std::string_view name) const;
  /// In the order in which they were first kept, without the start.
  const std::vector<std::pair<std::string, SavedStatePtr>>& all() const { return states_; }
  /// All names with that of the start, separated by blanks.
  std::string Names() const;

 private:
  std::vector<std::pair<std::string, SavedStatePtr>> states_;
};

/// What only the program as a whole can do. Called on the control thread.
class ControlActions {
 public:
  virtual ~ControlActions() = default;
  /// Closes a connection to `robot` with a notice.
  virtual void CloseClient(const std::string& robot, ClientId client, const std::string& reason) = 0;
  /// Begins to end the daemon; returns at once.
  virtual void Quit() = 0;
  /// The name of the file that is being recorded, and the page's URL; empty: none.
  virtual std::string recording() const = 0;
  /// Steps that the recording had to leave out so far.
  virtual std::uint64_t recording_lost() const { return 0; }
  /// Why nothing is recorded for now; empty: it is, or nothing is to be.
  virtual std::string recording_stall() const { return {}; }
  virtual std::string http() const = 0;
};

/// What /simulation acts on. All that it refers to outlives the module.
struct SimulationServices : GlobalServices {
  const RunControl& run;
  NameTable& names;
  RobotLibrary& robots;  // reads scenarios
  ControlActions& actions;
  /// Runs a function on the thread that reads scenarios, which can take seconds.
  std::function<void(std::function<void()>)> run_loader = {};
  std::optional<std::uint64_t> seed = std::nullopt;  // `--seed`: of every scenario that is loaded
};

class DrawnScenario;

class SimulationModule final : public GlobalModule {
 public:
  static constexpr std::size_t kMaxListed = 256;  // robots and clients in one status
  static constexpr std::size_t kMaxAwaited = 20;

  /// Any thread. `post` runs a function on the control thread.
  SimulationModule(SimulationServices services, StepInbox::Post post);
  ~SimulationModule() override;

  /// Tells those who have subscribed to get_clock the time once more if it stands still, so that programs
  /// that wait for the next one see that it is alive. To be called now and then.
  void RepeatClock();

 private:
  /// The text of get_status: robots `first` (from 1) and on, at most `count`.
  std::string StatusText(const Frame& frame, std::size_t first, std::size_t count) const;
  Message Read(const Message& request, const Frame& frame) override;
  command::Id first_reading() const override { return command::kGetStatus; }
  std::optional<Message> Change(Peer& peer, const Message& request) override;
  void OnAnswered(const Message& request, bool done) override;

  std::optional<Message> Load(Peer& peer, const LoadRequest& load);
  std::optional<Message> Save(Peer& peer, const Message& request);
  std::optional<Message> Restore(Peer& peer, const Message& request, const RestoreRequest& restore);
  Message ReadSaved(const Message& request) const;
  /// What `stop_all` has to say about robots that loaded controllers drive.
  std::string GoOnText() const;
  /// A number that a client logs.
  std::optional<Message> Log(Peer& peer, const Message& request);
  std::optional<Message> Release(Peer& peer, const Message& request, const edit::UnloadController& unload);
  /// Back to the start; a scenario with random keys is drawn anew for another seed.
  std::optional<Message> Reset(Peer& peer, const edit::Reset& reset);
  /// Push() for an edit after which the robots may be others.
  std::optional<Message> PushNewScene(Peer& peer, EditAction action);

  /// Hands the first of loads_ to the thread that reads scenarios.
  void BeginLoad();
  /// It is done; the next one.
  void EndLoad();

  const SimulationServices services_;
  std::deque<std::function<void()>> loads_;  // one after the other: the first is under way
  SavedStates saved_;
  std::optional<std::uint64_t> repeated_step_;  // when RepeatClock() was called last
  std::shared_ptr<DrawnScenario> drawn_;
};

}  // namespace coopdyn

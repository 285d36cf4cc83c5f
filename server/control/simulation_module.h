// SPDX-License-Identifier: MIT
// /simulation: the state of the run, and control of it. Free of sockets. The control thread only.
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

/// The states kept by `save`, by name.
class SavedStates {
 public:
  static constexpr std::size_t kMaxStates = 100;
  static constexpr std::size_t kMaxName = 63;
  /// The name of the start, which always exists.
  static constexpr std::string_view kStart = "start";

  /// The reason why `name` cannot be used; empty if it can.
  std::string Objection(const std::string& name) const;
  /// Replaces a state of the same name. @pre no Objection()
  void Keep(const std::string& name, SavedStatePtr state);
  /// Null if there is no such state.
  SavedStatePtr Find(std::string_view name) const;
  /// In the order of first saving, without the start.
  const std::vector<std::pair<std::string, SavedStatePtr>>& all() const { return states_; }
  /// All names including the start's, separated by blanks.
  std::string Names() const;

 private:
  std::vector<std::pair<std::string, SavedStatePtr>> states_;
};

/// Actions of the program as a whole. Called on the control thread.
class ControlActions {
 public:
  virtual ~ControlActions() = default;
  /// Closes a connection to `robot` with a notice.
  virtual void CloseClient(const std::string& robot, ClientId client, const std::string& reason) = 0;
  /// Starts to shut down the daemon; returns at once.
  virtual void Quit() = 0;
  /// The name of the file being recorded, and the page's URL; empty: none.
  virtual std::string recording() const = 0;
  /// Number of steps that the recording has left out so far.
  virtual std::uint64_t recording_lost() const { return 0; }
  /// Why recording is stalled; empty if it is not.
  virtual std::string recording_stall() const { return {}; }
  virtual std::string http() const = 0;
};

/// The services of /simulation. All referenced objects outlive the module.
struct SimulationServices : GlobalServices {
  const RunControl& run;
  NameTable& names;
  RobotLibrary& robots;  // reads scenarios
  ControlActions& actions;
  /// Runs a function on the thread that reads scenarios, which can take seconds.
  std::function<void(std::function<void()>)> run_loader = {};
  std::optional<std::uint64_t> seed = std::nullopt;  // `--seed`, for every loaded scenario
};

class DrawnScenario;

class SimulationModule final : public GlobalModule {
 public:
  static constexpr std::size_t kMaxListed = 256;  // robots and clients per status
  static constexpr std::size_t kMaxAwaited = 20;

  /// Any thread. `post` runs a function on the control thread.
  SimulationModule(SimulationServices services, StepInbox::Post post);
  ~SimulationModule() override;

  /// If the time stands still, pushes it again to the subscribers of get_clock, so that waiting programs see
  /// that the daemon is alive. Call it periodically.
  void RepeatClock();

 private:
  /// The text of get_status: at most `count` robots from `first` (from 1) on.
  std::string StatusText(const Frame& frame, std::size_t first, std::size_t count) const;
  Message Read(const Message& request, const Frame& frame) override;
  command::Id first_reading() const override { return command::kGetStatus; }
  std::optional<Message> Change(Peer& peer, const Message& request) override;
  void OnAnswered(const Message& request, bool done) override;
  std::string DeedOf(command::Id command, const EditResult& result) const override;

  std::optional<Message> Load(Peer& peer, const LoadRequest& load);
  std::optional<Message> Save(Peer& peer, const Message& request);
  std::optional<Message> Restore(Peer& peer, const Message& request, const RestoreRequest& restore);
  Message ReadSaved(const Message& request) const;
  /// The note of `stop_all` about robots driven by loaded controllers.
  std::string ResumeText() const;
  /// Stores a number that a client logs.
  std::optional<Message> Log(Peer& peer, const Message& request);
  std::optional<Message> Release(Peer& peer, const Message& request, const edit::UnloadController& unload);
  /// Returns to the start; redraws a scenario with random keys for another seed.
  std::optional<Message> Reset(Peer& peer, const edit::Reset& reset);
  /// Push() for an edit that may change the robots.
  std::optional<Message> PushNewScene(Peer& peer, EditAction action);

  /// Passes the first of loads_ to the thread that reads scenarios.
  void BeginLoad();
  /// The first load is done; starts the next one.
  void EndLoad();

  const SimulationServices services_;
  std::deque<std::function<void()>> loads_;  // run one after the other: the first is in progress
  SavedStates saved_;
  std::optional<std::uint64_t> repeated_step_;  // at the last RepeatClock()
  std::shared_ptr<DrawnScenario> drawn_;
};

}  // namespace coopdyn

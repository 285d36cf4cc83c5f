// SPDX-License-Identifier: MIT
// /simulation: how the run stands and goes on. Free of sockets. The control thread only.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>

#include "server/control/global_module.h"
#include "server/control/saved_states.h"
#include "server/control/simulation_services.h"

namespace coopdyn {

class SimulationModule final : public GlobalModule {
 public:
  static constexpr std::size_t kMaxListed = 256;  // robots and clients in one status
  static constexpr std::size_t kMaxAwaited = 20;

  /// Any thread. `post` runs a function on the control thread.
  SimulationModule(SimulationServices services, StepInbox::Post post);

  /// The text of get_status: robots `first` (from 1) and on, at most `count`.
  std::string StatusText(const Frame& frame, std::size_t first = 1, std::size_t count = kMaxListed) const;

 private:
  Message Read(const Message& request, const Frame& frame) override;
  command::Id first_reading() const override { return command::kGetStatus; }
  std::optional<Message> Refuse(const Message& request) const override;
  std::optional<Message> Change(Peer& peer, const Message& request) override;
  void OnAnswered(const Message& request, bool done) override;

  std::optional<Message> Reset(Peer& peer, const Message& request);
  std::optional<Message> Load(Peer& peer, const Message& request);
  std::optional<Message> Save(Peer& peer, const Message& request);
  std::optional<Message> Restore(Peer& peer, const Message& request);
  Message ReadSaved(const Message& request) const;
  /// What `stop_all` has to say about robots that loaded controllers drive.
  std::string GoOnText() const;
  std::optional<Message> ReleaseRobot(Peer& peer, const Message& request);
  /// Push() for an edit after which the robots may be others.
  std::optional<Message> PushNewScene(Peer& peer, EditAction action);

  /// Hands the first of loads_ to the thread that reads scenarios.
  void BeginLoad();

  const SimulationServices services_;
  std::deque<std::function<void()>> loads_;  // one after the other: the first is under way
  SavedStates saved_;
};

}  // namespace coopdyn

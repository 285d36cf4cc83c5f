// SPDX-License-Identifier: MIT
// /playback: drives a recording that is played. In a live run all its commands are refused. Free of sockets.
// The control thread only.
#pragma once

#include <functional>
#include <optional>

#include "server/control/branch_desk.h"
#include "server/control/global_module.h"
#include "server/state/run_control.h"

namespace coopdyn {

class PlaybackModule final : public GlobalModule {
 public:
  /// Called on the control thread after a branch, before its reply: the robots may be others.
  using ApplyScene = std::function<void(const Scene&)>;

  /// Any thread. All outlives the module.
  PlaybackModule(GlobalServices services, const RunControl& run, BranchDesk& branches, ApplyScene apply_scene,
                 StepInbox::Post post);

 private:
  Message Read(const Message& request, const Frame& frame) override;
  command::Id first_reading() const override { return command::kGetPlayback; }
  std::optional<Message> Refuse(const Message& request) const override;
  std::optional<Message> Change(Peer& peer, const Message& request) override;

  const RunControl& run_;
  BranchDesk& branches_;
  const ApplyScene apply_scene_;
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// /world: what stands in the world, edited live. Free of sockets. The control thread only.
#pragma once

#include <deque>
#include <functional>
#include <optional>

#include "server/control/global_module.h"
#include "server/control/world_edits.h"
#include "server/model/readers.h"
#include "server/state/run_control.h"

namespace coopdyn {

/// What /world acts on; all outlives the module.
struct WorldServices : GlobalServices {
  const RunControl& run;
  RobotLibrary& robots;  // reads models
  /// Runs a function on a thread that reads files, which can take seconds.
  std::function<void(std::function<void()>)> run_loader;
};

class WorldModule final : public GlobalModule {
 public:
  /// Any thread. `post` runs a function on the control thread.
  WorldModule(WorldServices services, StepInbox::Post post);

 private:
  Message Read(const Message& request, const Frame& frame) override;
  command::Id first_reading() const override { return command::kGetWorld; }
  std::optional<Message> Change(Peer& peer, const Message& request) override;

  /// Hands the first of requests_ to the thread that reads files.
  void Begin();

  const WorldServices services_;
  /// One after the other, so that each sees what the one before has changed; the first is under way.
  std::deque<std::function<void()>> requests_;
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// /world: live edits of the world. Free of sockets. The control thread only.
#pragma once

#include <deque>
#include <functional>
#include <optional>

#include "server/control/global_module.h"
#include "server/control/world_edits.h"
#include "server/model/readers.h"
#include "server/state/run_control.h"

namespace coopdyn {

/// The services of /world; all outlive the module.
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
  /// As the stepper's event says it.
  std::string DeedOf(command::Id /*command*/, const EditResult& result) const override {
    return result.change.label;
  }

  /// Passes the first of requests_ to the thread that reads files.
  void Begin();

  const WorldServices services_;
  /// Run one after the other, so that each request sees the changes of the one before; the first is in
  /// progress.
  std::deque<std::function<void()>> requests_;
};

}  // namespace coopdyn

// SPDX-License-Identifier: MIT
// What /simulation acts on. All that it refers to outlives the module.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "server/base/clock.h"
#include "server/devices/connection_roster.h"
#include "server/devices/token_guard.h"
#include "server/model/readers.h"
#include "server/naming/name_table.h"
#include "server/state/command_board.h"
#include "server/state/edit_queue.h"
#include "server/state/frame_board.h"
#include "server/state/run_control.h"

namespace coopdyn {

/// What only the program as a whole can do. Called on the control thread.
class ControlActions {
 public:
  virtual ~ControlActions() = default;
  /// The world has been reset, loaded or restored: brings the robots' modules into line with `scene`, before
  /// the reply is sent.
  virtual void ApplyScene(const Scene& scene) = 0;
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

struct SimulationServices {
  CommandBoard& board;
  const FrameBoard& frames;
  EditQueue& edits;
  const RunControl& run;
  NameTable& names;
  ConnectionRoster& roster;
  RobotLibrary& robots;     // reads scenarios
  const TokenGuard& guard;  // required
  const Clock& clock;
  ControlActions& actions;
  std::string version;
  std::optional<std::uint64_t> seed = std::nullopt;  // `--seed`: of every scenario that is loaded
  /// Runs a function on the thread that reads scenarios, which can take seconds.
  std::function<void(std::function<void()>)> run_loader = {};
};

}  // namespace coopdyn

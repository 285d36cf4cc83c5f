// SPDX-License-Identifier: MIT
// Plays a recording: publishes its frames instead of physics, so that modules, pictures and the page show
// them as they showed the run. On the physics thread.
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/record/run_reader.h"
#include "server/state/command_board.h"
#include "server/state/doorbell.h"
#include "server/state/edit_queue.h"
#include "server/state/frame_board.h"
#include "server/state/run_control.h"

namespace coopdyn {

inline constexpr double kMinPlaySpeed = -4, kMaxPlaySpeed = 64;

struct PlayOptions {
  double speed = 1;  // −4…64, not 0
  bool loop = false;
  bool paused = false;
  Nanoseconds start = 0;  // simulated time to begin at
};

class Player {
 public:
  struct Boards {
    FrameBoard& frames;
    CommandBoard& commands;
    EditQueue& edits;
    RunControl& control;
    Doorbell& bell;
  };

  /// `reader` has its scenario loaded. `epoch`: of the frames published so far.
  Player(Boards boards, std::unique_ptr<RunReader> reader, const Clock& clock, Logger logger,
         PlayOptions options, std::uint64_t epoch = 0);
  ~Player();

  /// Publishes the first frame; an error text, empty if all is well. Before Run().
  std::string Start();
  /// Plays until `stop` is requested (ring the bell after), which ends all waits; or until an edit ends the
  /// playback (Restore): returns that edit, for the live run to apply.
  std::optional<Edit> Run(std::stop_token stop);
  std::uint64_t epoch() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coopdyn

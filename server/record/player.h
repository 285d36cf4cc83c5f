// SPDX-License-Identifier: MIT
// Plays a recording: publishes its frames in place of physics. Modules, pictures and the page show them as
// they showed the run. On the physics thread.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/record/logged_numbers.h"
#include "server/record/player_frames.h"
#include "server/record/run_reader.h"
#include "server/state/command_board.h"
#include "server/state/doorbell.h"
#include "server/state/edit_queue.h"
#include "server/state/frame_board.h"
#include "server/state/run_control.h"
#include "server/timing/pace.h"

namespace coopdyn {

struct PlayOptions {
  double speed = 1;  // −4…64, not 0
  bool loop = false;
  bool paused = false;
  Nanoseconds start = 0;  // simulated time to begin at
};

/// Decides which moment of a recording is due: simulated time runs at `speed` times the wall clock from where
/// Start() set it. Pure: the caller passes the wall time.
class PlayPace {
 public:
  /// Sets the moment due at wall time `now` to `time`. `speed` is not 0; negative plays backwards.
  void Start(Nanoseconds now, Nanoseconds time, double speed) {
    wall_ = now;
    time_ = time;
    speed_ = speed;
  }
  double speed() const { return speed_; }
  /// The simulated time due at wall time `now`.
  Nanoseconds DueTime(Nanoseconds now) const {
    return time_ + static_cast<Nanoseconds>(std::floor(static_cast<double>(now - wall_) * speed_));
  }
  /// The first wall time at which `time` is due. Backwards: the first at which an earlier moment is due, so
  /// the frame of `time` no longer is.
  Nanoseconds WallTime(Nanoseconds time) const {
    const auto ahead = static_cast<double>(time - time_);
    if (speed_ > 0) return wall_ + static_cast<Nanoseconds>(std::ceil(ahead / speed_));
    return wall_ + static_cast<Nanoseconds>(std::floor(ahead / speed_)) + 1;
  }

 private:
  Nanoseconds wall_ = 0, time_ = 0;
  double speed_ = 1;
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

  /// `reader` has its scenario loaded; from now on only the player uses it. `epoch`: of the frames published
  /// so far.
  Player(Boards boards, std::shared_ptr<RunReader> reader, const Clock& clock, Logger logger,
         PlayOptions options, std::uint64_t epoch = 0);

  /// `on_scene` is called on the physics thread when the scene changes during playback, because things or
  /// robots were added or removed. Before Run().
  void set_on_scene(std::function<void(std::shared_ptr<const Scene>)> on_scene) {
    on_scene_ = std::move(on_scene);
  }
  /// Publishes the first frame. Returns an error text, empty on success. Before Run().
  std::string Start() { return Start(clock_.Now()); }
  /// Plays until `stop` is requested (ring the bell afterwards), then ends all pending requests. Returns
  /// early with the edit that ends the playback: Restore, for the live run to apply, or Play, another
  /// recording.
  std::optional<Edit> Run(std::stop_token stop);
  std::uint64_t epoch() const { return epoch_; }

  // The parts of Run(), for callers that pass the time themselves. They never block.
  std::string Start(Nanoseconds now);
  /// Starts the clock, or restarts it after a pause of unknown length.
  void Resume(Nanoseconds now);
  struct Work {
    Nanoseconds wake = 0;          // wall time of the next call; INT64_MAX: when the bell rings
    std::optional<Edit> ended_by;  // set if the playback is over
  };
  /// Applies edits, shows the frame that is due, and returns when to call again.
  Work WorkOnce(Nanoseconds now);
  /// Ends all pending requests.
  void Stop();

 private:
  struct PendingStep {
    std::int64_t left = 0;  // frames, including those of earlier requests
    std::int64_t asked = 1;
    StepDone done;
  };
  struct Place {
    std::uint64_t step = 0;
    Nanoseconds time = 0;
  };
  enum class Jump { kNo, kYes };

  // Each handles one kind of edit and returns its result.
  EditResult Apply(const edit::Run&);
  EditResult Apply(const edit::Pause&);
  EditResult Apply(const edit::Step& step, StepDone done);
  EditResult Apply(const edit::Reset&);
  EditResult Apply(const edit::Seek&);
  EditResult Apply(const edit::Skip&);
  EditResult Apply(const edit::SetPlaySpeed&);
  EditResult Apply(const edit::SetLoop&);
  /// Applies any kind of edit; refuses those that do not control the playback.
  EditResult ApplyAny(Edit& edit);

  /// Applies the queued edits; returns the edit that ends the playback.
  std::optional<Edit> ApplyEdits();
  Nanoseconds ShowDue();
  Nanoseconds Resume();
  Nanoseconds GoByStep();
  /// At an end: wraps around, waits for more frames, or stops.
  Nanoseconds AtEnd(bool back);
  /// Shows `step`. False, with reader_->error() set, if the file is damaged there.
  bool Show(std::uint64_t step, Jump jump);
  /// Shows `step` during playback: damage becomes an event and stops the playback.
  bool ShowOrStand(std::uint64_t step, Jump jump);
  /// Jumps to `step` for an edit and ends pending step requests.
  EditResult JumpTo(std::optional<std::uint64_t> step);
  /// The step `steps` recorded steps away from the shown one, clamped to the ends; nullopt if damaged.
  std::optional<std::uint64_t> StepAway(int steps);
  /// The next frame in a direction; nullopt at the end, or with reader_->error() set if damaged.
  std::optional<Place> Next(bool back);
  void Stand();
  /// Reports the reader's error as an event and stops the playback.
  Nanoseconds Fail();
  /// Updates the extent of a growing file, at most once every kLookEvery unless `always`.
  void Look(bool always);
  void RestartPace(Nanoseconds time);
  void EndSteps(StepEnd end);
  std::int64_t steps_left() const;
  double pace_speed() const;
  void AddEvent(const char* level, std::string text);
  void PublishStatus();

  const Boards boards_;
  const std::shared_ptr<RunReader> reader_;
  const Clock& clock_;
  const Logger logger_;
  const PlayOptions options_;
  std::function<void(std::shared_ptr<const Scene>)> on_scene_;
  PlayFrames frames_;
  PlayPace pace_;
  RateMeter rate_;
  RunExtent extent_;
  LoggedNumbers logged_;
  std::int64_t newest_event_ = 0;  // row id of the newest event in logged_
  FramePtr shown_;
  std::optional<Place> next_;  // the frame after the shown one, once looked up
  bool next_is_back_ = false;
  std::uint64_t epoch_;
  double speed_;
  bool loop_;
  bool playing_;
  bool changed_ = true;  // since the status was last published
  std::vector<PendingStep> steps_;
  Nanoseconds now_ = 0;  // wall time of the current call
  Nanoseconds shown_at_ = 0, looked_at_ = 0, status_at_ = 0;
};

}  // namespace coopdyn

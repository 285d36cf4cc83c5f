// SPDX-License-Identifier: MIT
// Plays a recording: publishes its frames instead of physics, so that modules, pictures and the page show
// them as they showed the run. On the physics thread.
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

/// Which moment of a recording is due: simulated time that runs at `speed` times the wall clock from where it
/// was set. Pure: the caller says what time it is.
class PlayPace {
 public:
  /// At wall time `now` the moment `time` is due. `speed` is not 0; below 0: backwards.
  void Start(Nanoseconds now, Nanoseconds time, double speed) {
    wall_ = now;
    time_ = time;
    speed_ = speed;
  }
  double speed() const { return speed_; }
  /// The simulated time that is due at wall time `now`.
  Nanoseconds DueTime(Nanoseconds now) const {
    return time_ + static_cast<Nanoseconds>(std::floor(static_cast<double>(now - wall_) * speed_));
  }
  /// The first moment of wall time at which `time` is due; backwards: at which a moment before it is, so that
  /// the frame of `time` is due no more.
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

  /// `reader` has its scenario loaded, and is the player's from now on. `epoch`: of the frames published so
  /// far.
  Player(Boards boards, std::shared_ptr<RunReader> reader, const Clock& clock, Logger logger,
         PlayOptions options, std::uint64_t epoch = 0);

  /// Called on the physics thread when another scene is shown while it plays: things and robots have come or
  /// gone. Before Run().
  void set_on_scene(std::function<void(std::shared_ptr<const Scene>)> on_scene) {
    on_scene_ = std::move(on_scene);
  }
  /// Publishes the first frame; an error text, empty if all is well. Before Run().
  std::string Start() { return Start(clock_.Now()); }
  /// Plays until `stop` is requested (ring the bell after), which ends all waits; or until an edit ends the
  /// playback (Restore: for the live run to apply; Play: another recording): returns that edit.
  std::optional<Edit> Run(std::stop_token stop);
  std::uint64_t epoch() const { return epoch_; }

  // What Run() does, at a moment that the caller says: it never waits.
  std::string Start(Nanoseconds now);
  /// Time begins to run, or goes on after a wait of unknown length.
  void Resume(Nanoseconds now);
  struct Work {
    Nanoseconds wake = 0;          // when to look again; INT64_MAX: when the bell rings
    std::optional<Edit> ended_by;  // the playback is over
  };
  /// Applies edits, shows the frame that is due, says when to look again.
  Work WorkOnce(Nanoseconds now);
  /// Ends all waits.
  void Stop();

 private:
  struct PendingStep {
    std::int64_t left = 0;  // frames, those that others wait for included
    std::int64_t asked = 1;
    StepDone done;
  };
  struct Place {
    std::uint64_t step = 0;
    Nanoseconds time = 0;
  };
  enum class Jump { kNo, kYes };

  // Each handles one kind of edit and returns what to answer.
  EditResult Apply(const edit::Run&);
  EditResult Apply(const edit::Pause&);
  EditResult Apply(const edit::Step& step, StepDone done);
  EditResult Apply(const edit::Reset&);
  EditResult Apply(const edit::Seek&);
  EditResult Apply(const edit::Skip&);
  EditResult Apply(const edit::SetPlaySpeed&);
  EditResult Apply(const edit::SetLoop&);
  /// The same for any kind; what does not move the player is refused.
  EditResult ApplyAny(Edit& edit);

  /// Applies what waits; returns the edit that ends the playback.
  std::optional<Edit> ApplyEdits();
  Nanoseconds ShowDue();
  Nanoseconds GoOn();
  Nanoseconds GoByStep();
  /// At an end: wraps, waits or stands.
  Nanoseconds AtEnd(bool back);
  /// Shows `step`; false if the file is damaged there, and reader_->error() says so.
  bool Show(std::uint64_t step, Jump jump);
  /// The same while it plays: a damage is an event, and it stands.
  bool ShowOrStand(std::uint64_t step, Jump jump);
  /// Where a jump of an edit leads; waits for steps are undone.
  EditResult JumpTo(std::optional<std::uint64_t> step);
  /// The step that many recorded ones from what is shown, or the end before it; nothing if damaged.
  std::optional<std::uint64_t> StepAway(int steps);
  /// The next frame in a direction; nothing at the end, or (reader_->error()) if damaged.
  std::optional<Place> Next(bool back);
  void Stand();
  /// A damage: an event, and it stands.
  Nanoseconds Fail();
  /// Looks how far a growing file has come; at most each kLookEvery unless `always`.
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
  std::int64_t newest_event_ = 0;  // of those that logged_ has seen
  FramePtr shown_;
  std::optional<Place> next_;  // after what is shown, once it was looked for
  bool next_is_back_ = false;
  std::uint64_t epoch_;
  double speed_;
  bool loop_;
  bool playing_;
  bool changed_ = true;  // since the status was published
  std::vector<PendingStep> steps_;
  Nanoseconds now_ = 0;  // of this call
  Nanoseconds shown_at_ = 0, looked_at_ = 0, status_at_ = 0;
};

}  // namespace coopdyn
